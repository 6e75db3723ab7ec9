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
/// A latched fault in words; empty for 0.
[[nodiscard]] std::string faultText(std::int32_t fault);

}  // namespace rc10::link
