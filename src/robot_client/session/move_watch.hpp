#pragma once

#include <optional>
#include <string>

#include "app/time.hpp"
#include "rc10/move.hpp"
#include "rc10/robot_state.hpp"

namespace rc10 {
inline namespace robot_client {

/// Goal of one moveTo().
struct MoveGoal {
  std::string motor;
  Mode mode = Mode::kTotalAngle;  ///< kTotalAngle or kAngle.
  double target_deg = 0.0;
  double tolerance_deg = 1.0;
  Duration timeout{};
};

/// Watches one moveTo(): states, events and time in, its result out, once. Pure.
class MoveWatch {
 public:
  MoveWatch(MoveGoal goal, std::string client, MonotonicTime now)
      : goal_(std::move(goal)), client_(std::move(client)), started_(now), last_heard_(now), obeyed_(now) {}

  [[nodiscard]] const std::string& motor() const noexcept { return goal_.motor; }

  [[nodiscard]] std::optional<MoveResult> onState(const RobotState& state, MonotonicTime now);
  /// Keeps what rc10d says about a setpoint that it skipped or refused.
  void onEvent(const Event& event);
  [[nodiscard]] std::optional<MoveResult> onTime(MonotonicTime now) const;
  [[nodiscard]] MonotonicTime deadline() const noexcept { return started_ + goal_.timeout; }

  [[nodiscard]] MoveResult failed(std::string reason) const;

 private:
  [[nodiscard]] std::optional<std::string> notObeyed(const MotorState& motor) const;
  [[nodiscard]] double distance() const;

  MoveGoal goal_;
  std::string client_;
  MonotonicTime started_;
  MonotonicTime last_heard_;
  MonotonicTime obeyed_;  ///< Time of the last state that showed the target, or the start.
  double angle_deg_ = kUnknown;
  std::optional<std::int64_t> within_since_us_;  ///< By the host's clock.
  std::string refusal_;
};

}  // namespace robot_client
}  // namespace rc10
