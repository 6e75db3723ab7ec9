#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>

#include "app/target.hpp"
#include "app/time.hpp"
#include "daemon/clients/command_budget.hpp"
#include "daemon/clients/permissions.hpp"
#include "daemon/clients/session_numbers.hpp"
#include "daemon/clients/validity.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/robot_description.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Reason why a command message was refused. A message is refused whole.
enum class CommandRefusal : std::uint8_t {
  kNone,
  kMalformed,  ///< No setpoints, one motor twice, or a validity out of range.
  kUnknownMotor,
  kUnknownMode,
  kUnsupportedMode,  ///< The motor's drive cannot do it.
  kNotFinite,
  kExpired,      ///< Older than its own validity when it came in.
  kOldSequence,  ///< Not above the last sequence number of its session.
  kRingFull,     ///< More than the scheduler takes, or than this client's share of it.
  kUnknownModule,
  kUnknownSignal,     ///< The module has no such input.
  kUnusedField,       ///< Not refused: a field that its mode does not use was cleared.
  kNotPermitted,      ///< `clients` does not grant it, or its name or session is another's. Requests too.
  kGainsBeyondDrive,  ///< Stiffness or damping that the drive's frames cannot say.
};
inline constexpr std::size_t kCommandRefusalCount = 14;

/// The name of the counter.
[[nodiscard]] const char* toString(CommandRefusal refusal) noexcept;
/// Cause and remedy.
[[nodiscard]] const char* describe(CommandRefusal refusal) noexcept;

/// Checks command messages before they reach the scheduler. Link thread only; the time is an argument.
class Admission {
 public:
  /// The robot outlives it.
  explicit Admission(const RobotDescription& robot, Permissions permissions = {});

  /// Translates a message; on refusal `out` is unspecified. `now` is CLOCK_MONOTONIC.
  [[nodiscard]] CommandRefusal admit(const link::Command& message, const Speaker& speaker, MonotonicTime now,
                                     Command& out);

  [[nodiscard]] const Permissions& permissions() const noexcept { return permissions_; }
  /// After kNotPermitted, why.
  [[nodiscard]] const std::string& whyNotPermitted() const noexcept { return not_permitted_; }

  /// Whether the last message came too late to act, and yet is the newest of its session: targets that this
  /// sent before are past. `out` is translated.
  [[nodiscard]] bool lateButNew() const noexcept { return late_but_new_; }

  /// Whether the last message that was accepted had a field that its mode does not use.
  [[nodiscard]] bool clearedField() const noexcept { return cleared_field_; }

  /// "wheel: impedance": motor and mode for which the last message was refused; empty: not for one of them.
  [[nodiscard]] const std::string& culprit() const noexcept { return culprit_; }

  /// Modes or gains that the culprit takes instead: "; it has current,velocity" after kUnsupportedMode, ": 0
  /// to 500 Nm/rad, 0 to 5 Nms/rad" after kGainsBeyondDrive; else empty.
  [[nodiscard]] const std::string& choice() const noexcept { return choice_; }

  /// Index of a motor, or -1.
  [[nodiscard]] int indexOf(std::string_view name) const;

  void count(CommandRefusal refusal) noexcept { ++refusals_[static_cast<std::size_t>(refusal)]; }
  /// Messages refused since start, by reason; kNone counts the accepted ones.
  [[nodiscard]] const std::array<std::uint64_t, kCommandRefusalCount>& counts() const noexcept {
    return refusals_;
  }

 private:
  [[nodiscard]] CommandRefusal translate(const link::Setpoint& in, Command::Setpoint& out) const;

  const RobotDescription& robot_;
  Permissions permissions_;
  std::string not_permitted_;
  std::unordered_map<std::string, int> index_;
  SessionNumbers sessions_;
  CommandBudget budget_;
  std::array<std::uint64_t, kCommandRefusalCount> refusals_{};
  bool cleared_field_ = false;
  bool late_but_new_ = false;
  std::string culprit_;
  std::string choice_;
};

}  // namespace rc10
