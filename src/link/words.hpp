#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// The numbers of the protocol in words, for programs that are not built on the motor layer. The numbers
/// and the words are those of lcm_types/ and of the daemon.
namespace rc10::link {

inline constexpr std::uint8_t kModeCoast = 0;
inline constexpr std::uint8_t kModeImpedance = 5;
inline constexpr std::uint8_t kModeBrake = 8;
inline constexpr std::uint8_t kModeCount = 9;

inline constexpr std::uint8_t kMotorOffline = 0;
inline constexpr std::uint8_t kMotorEnabling = 2;
inline constexpr std::uint8_t kMotorActive = 3;
inline constexpr std::uint8_t kMotorFault = 4;

inline constexpr std::uint8_t kRobotRun = 0;

/// "OFFLINE", "READY", ...; "UNKNOWN".
[[nodiscard]] const char* motorStatusWord(std::uint8_t status) noexcept;
/// "RUN", "ESTOP", "STOPPING"; "UNKNOWN".
[[nodiscard]] const char* robotStateWord(std::uint8_t state) noexcept;
/// "active", ..., "bus-off", "stalled"; "unknown".
[[nodiscard]] const char* busStateWord(std::uint8_t state) noexcept;
/// "info", "warning", "error"; "unknown".
[[nodiscard]] const char* severityWord(std::uint8_t severity) noexcept;

/// "coast", "current", "velocity", ...; "unknown".
[[nodiscard]] const char* modeWord(std::uint8_t mode) noexcept;
[[nodiscard]] std::optional<std::uint8_t> modeOf(std::string_view word) noexcept;
/// The unit of a mode's target, "" where there is none.
[[nodiscard]] const char* modeUnit(std::uint8_t mode) noexcept;
/// Every mode in a bit set (MotorInfo::modes), separated by commas.
[[nodiscard]] std::string modeWords(std::uint32_t modes);

/// The unit of MotorState::command_value: "A", "V", "native"; "" where nothing is sent.
[[nodiscard]] const char* commandUnitWord(std::uint8_t unit) noexcept;

/// The key of a gain, by its number in event 110: "velocity_pid.kp_a_per_rpm"; "unknown gain".
[[nodiscard]] const char* gainWord(std::int32_t gain) noexcept;

/// The limits that act (MotorState::limits), separated by commas: "current,stall".
[[nodiscard]] std::string limitWords(std::uint32_t limits);
/// A latched fault in words; empty for 0.
[[nodiscard]] std::string faultText(std::int32_t fault);

}  // namespace rc10::link
