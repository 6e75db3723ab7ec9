#pragma once

#include <future>
#include <optional>
#include <string>
#include <vector>

#include "robot_client/session/held_targets.hpp"
#include "robot_client/session/moves.hpp"
#include "robot_client/session/news.hpp"
#include "robot_client/session/session_core.hpp"

namespace rc10 {
inline namespace robot_client {

/// Targets of a program: sent at once, again as long as they are held, and the moves that end at them.
class SessionTargets {
 public:
  explicit SessionTargets(SessionCore& core) : core_(core) {}

  Result<void> command(const MotorSetpoints& setpoints);
  [[nodiscard]] std::future<MoveResult> moveTo(const MoveGoal& goal);
  void alive();

  // With the mutex held.
  void aliveAt(MonotonicTime now) noexcept { held_.alive(now); }
  [[nodiscard]] bool holds(const std::string& motor) const { return held_.holds(motor); }
  void onState(const RobotState& state, MonotonicTime now, News& news);
  void onEvent(const Event& event, News& news);
  /// Without names: all.
  void release(const std::vector<std::string>& motors);
  void sendAgain(MonotonicTime now, News& news);
  [[nodiscard]] std::optional<MonotonicTime> nextDue(MonotonicTime now) const;
  /// The program leaves: RobotOptions::at_end.
  void letGo(MonotonicTime now, News& news);

 private:
  [[nodiscard]] Result<void> mayCommand(const MotorSetpoints& setpoints, MonotonicTime now) const;
  [[nodiscard]] std::int64_t shownUs() const;  ///< mono_us of the newest state.
  Result<void> publish(const MotorSetpoints& setpoints);
  void drop(const std::vector<HeldTargets::Dropped>& dropped, News& news);

  SessionCore& core_;
  HeldTargets held_{core_.options.resend, core_.options.validity, core_.options.alive_within};
  Moves moves_{held_};
};

}  // namespace robot_client
}  // namespace rc10
