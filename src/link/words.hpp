#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "app/vocabulary.hpp"

/// Words of the protocol that take more than a table: app/vocabulary.hpp has the others.
namespace rc10::link {

[[nodiscard]] std::optional<ControlMode> modeOf(std::string_view word) noexcept;
/// Every mode in a bit set (MotorInfo::modes), separated by commas.
[[nodiscard]] std::string modeWords(std::uint32_t modes);

/// The key of a gain, by its number in event 110: "velocity_pid.kp_a_per_rpm"; "unknown gain".
[[nodiscard]] const char* gainWord(std::int32_t gain) noexcept;

/// The limits that act (MotorState::limits), separated by commas: "current,stall".
[[nodiscard]] std::string limitWords(std::uint32_t limits);
/// Reason why a motor does not obey, or the robot does not run, in words: "asked for by 'teleop'". For
/// kNone only by whom, or nothing.
[[nodiscard]] std::string stopText(StopCause cause, std::string_view stopped_by);
/// The conditions of a robot, separated by commas: "simulated".
[[nodiscard]] std::string conditionWords(std::uint32_t conditions);
/// A latched fault in words; empty for 0.
[[nodiscard]] std::string faultText(std::int32_t fault);

}  // namespace rc10::link
