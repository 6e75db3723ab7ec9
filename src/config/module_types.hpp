#pragma once

#include <span>
#include <string_view>

#include "app/result.hpp"
#include "module/module_type.hpp"

namespace rc10 {

/// All types of modules: those of rc10d, and those that a program which embeds it has added. Main thread,
/// before start.
[[nodiscard]] std::span<const ModuleType* const> moduleTypes();

/// Adds a type. Refused, with the reason, if its name is taken, if a key has the name of one that every
/// module has, or once a configuration has been read: its keys are part of what is accepted. `type` lives as
/// long as the program.
[[nodiscard]] Result<void> addModuleType(const ModuleType& type);

/// nullptr: there is none.
[[nodiscard]] const ModuleType* findModuleType(std::string_view name);

}  // namespace rc10
