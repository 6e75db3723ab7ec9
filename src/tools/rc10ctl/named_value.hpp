#pragma once

#include <string>
#include <string_view>

#include "app/result.hpp"
#include "link/link_protocol.hpp"

namespace rc10::ctl {

/// "vx_m_s=0.5". The error shows `example`.
[[nodiscard]] Result<link::NamedValue> namedValue(const std::string& text, std::string_view example);

}  // namespace rc10::ctl
