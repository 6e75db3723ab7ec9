#pragma once

#include <cstddef>
#include <string>

#include "app/result.hpp"

namespace rc10::ctl {

/// A QR code as lines of half blocks, light where there is ink: for a dark terminal.
struct QrPicture {
  std::size_t columns = 0;
  std::string lines;
};

/// `coloured`: white on black whatever the terminal's colours are.
[[nodiscard]] Result<QrPicture> qrPicture(const std::string& text, bool coloured);

}  // namespace rc10::ctl
