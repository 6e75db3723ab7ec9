#pragma once

#include <span>
#include <string_view>

#include "app/result.hpp"
#include "drives/families.hpp"

namespace rc10 {

/// All families: those of rc10d, and those that a program which embeds it has added. Main thread, before
/// start.
[[nodiscard]] std::span<const FamilyEntry> motorFamilies();

/// Adds a family. Refused, with the reason, if a model has a name that is taken, if a key has the name of
/// another key, or once a configuration has been read: its keys are part of what is accepted. `entry.family`
/// lives as long as the program.
[[nodiscard]] Result<void> addMotorFamily(const FamilyEntry& entry);

/// nullptr: no family has such a model.
[[nodiscard]] const FamilyEntry* findFamily(std::string_view model);

}  // namespace rc10
