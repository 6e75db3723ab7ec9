#pragma once

#include <optional>

#include "robot_client/session/estop_repetition.hpp"
#include "robot_client/session/session_core.hpp"
#include "robot_client/session/session_targets.hpp"

namespace rc10 {
inline namespace robot_client {

/// Emergency stop of a program: sent at once, and again until a state shows it.
class SessionEstop {
 public:
  SessionEstop(SessionCore& core, SessionTargets& targets) : core_(core), targets_(targets) {}

  Result<void> estop(Duration timeout);
  /// When nobody sends it again any more: what is under way goes on until a state shows it, so long at most.
  Result<void> finish(Duration most);

  // With the mutex held.
  void onState(const RobotState& state) noexcept {
    if (state.status == RobotStatus::kEstop) repetition_.shown(state.taken);
  }
  void sendAgain(MonotonicTime now) {
    if (const auto number = repetition_.due(now)) (void)send(*number, now);
  }
  [[nodiscard]] std::optional<MonotonicTime> nextDue() const noexcept { return repetition_.nextDue(); }

 private:
  [[nodiscard]] tl::unexpected<Error> notShown(Duration after) const;
  Result<void> send(std::int64_t number, MonotonicTime now);

  SessionCore& core_;
  SessionTargets& targets_;
  EstopRepetition repetition_;
};

}  // namespace robot_client
}  // namespace rc10
