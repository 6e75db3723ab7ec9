#pragma once

#include <string_view>

/// Values of a request with which its effect ends with the connection of its client, however that ends.
namespace rc10::link {

/// Value of `enable` and `enable_alone`: the motors are disabled then.
inline constexpr std::string_view kDisableAtEnd = "disable_at_end";
/// Value of `set_gains`: the gains of before are in force again then.
inline constexpr std::string_view kRestoreAtEnd = "restore_at_end";

}  // namespace rc10::link
