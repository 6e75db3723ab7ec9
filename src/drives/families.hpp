#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "drives/recogniser.hpp"
#include "drives/wording.hpp"
#include "motor/motor_family.hpp"
#include "sim/drive.hpp"

namespace rc10 {

/// One family of motors, as the rest of the program finds it.
struct FamilyEntry {
  const MotorFamily* family = nullptr;
  /// Makes the simulated drive of a motor; null: this family cannot be simulated.
  std::unique_ptr<sim::Drive> (*simulate)(const MotorSettings& settings,
                                          const sim::MotorLoad& load) = nullptr;
  /// Guess of `rc10ctl scan` about a frame's sender; null: scan does not know this family.
  Recogniser recognise = nullptr;
  /// Its frames in words, for those who read a recording; null: they stay numbers.
  Wording word = nullptr;
  /// Questions for `rc10ctl scan`; null: none of its questions is safe on a bus of unknown drives.
  const ScanQuestions* questions = nullptr;
  /// Drive that would obey the question of another family; null: none of this family would.
  ObeyedBy obeyed_by = nullptr;
  /// Drives that send nothing but answers: the family's name, or that of a part of it; empty: none.
  std::string_view only_answer{};
  /// Whether a drive with this id may have sent the frame, where the file says so and recognise() does not
  /// know the frame's id; null: it knows all.
  bool (*speaks)(const CanFrame& frame, int id) = nullptr;
};

/// The families of rc10d: the one place where a new one is entered.
[[nodiscard]] std::span<const FamilyEntry> builtInFamilies();

}  // namespace rc10
