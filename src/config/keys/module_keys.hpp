#pragma once

#include <string_view>

namespace rc10 {

/// Whether every module has such a key.
[[nodiscard]] bool isCommonModuleKey(std::string_view name);

/// Whether the tables of the modules' keys are made: types that are added now would come too late.
[[nodiscard]] bool moduleKeysMade() noexcept;

}  // namespace rc10
