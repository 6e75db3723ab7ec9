#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "app/result.hpp"
#include "motor/motor_family.hpp"
#include "sim/drive.hpp"

namespace rc10 {

/// One family of motors, as the rest of the program finds it.
struct FamilyEntry {
  const MotorFamily* family = nullptr;
  /// Makes the simulated drive of a motor; null: this family cannot be simulated.
  std::unique_ptr<sim::Drive> (*simulate)(const MotorSettings& settings,
                                          const sim::MotorLoad& load) = nullptr;
};

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
