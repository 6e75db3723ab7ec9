// A module of one's own: a gripper that closes until it holds something. See docs/adding-a-module.md.
#pragma once

#include "module/module_type.hpp"

namespace shop {

[[nodiscard]] const rc10::ModuleType& gripperType() noexcept;

}  // namespace shop
