#pragma once

#include <string>
#include <string_view>

namespace rc10 {

/// "; did you mean can0?" for the name of a network interface that this computer does not have; empty if none
/// is near. Start-up only.
[[nodiscard]] std::string similarInterface(std::string_view name);

/// The same, and where to look for what there is: "; did you mean can0?; `ip link` lists …".
[[nodiscard]] std::string adviceForMissing(std::string_view name);

}  // namespace rc10
