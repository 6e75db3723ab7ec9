#pragma once

#include "client/screen_fit.hpp"

namespace rc10::ctl {

/// Whether to write colours there: it is a terminal, and NO_COLOR (no-color.org) is not set.
[[nodiscard]] bool coloured(int descriptor) noexcept;

/// Size of the terminal there, as it is now: it may be resized at any time.
[[nodiscard]] client::ScreenSize screenSize(int descriptor) noexcept;

/// Whether text there may hold more than ASCII, after LC_ALL, LC_CTYPE and LANG.
[[nodiscard]] bool utf8();

}  // namespace rc10::ctl
