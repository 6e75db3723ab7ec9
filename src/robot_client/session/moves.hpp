#pragma once

#include <future>
#include <optional>
#include <string>
#include <vector>

#include "robot_client/session/held_targets.hpp"
#include "robot_client/session/move_watch.hpp"

namespace rc10 {
inline namespace robot_client {

/// The moveTo() calls that are under way. A move that fails lets go of its target. Ended moves are added to
/// `ended`, so that promises are kept when no mutex is held. Pure.
class Moves {
 public:
  struct Ended {
    std::promise<MoveResult> promise;
    MoveResult result;

    void tell() { promise.set_value(std::move(result)); }
  };

  explicit Moves(HeldTargets& held) : held_(held) {}

  void start(MoveWatch watch, std::promise<MoveResult> promise);

  void onState(const RobotState& state, MonotonicTime now, std::vector<Ended>& ended);
  void onEvent(const Event& event);
  void onTime(MonotonicTime now, std::vector<Ended>& ended);

  /// Other targets for these motors have been given, and stay.
  void supersede(const MotorSetpoints& setpoints, std::vector<Ended>& ended);
  void fail(const std::string& motor, const std::string& reason, std::vector<Ended>& ended);
  void failAll(const std::string& reason, std::vector<Ended>& ended);

  /// When onTime() is due; none without moves.
  [[nodiscard]] std::optional<MonotonicTime> nextLook(MonotonicTime now) const;

 private:
  struct Move {
    MoveWatch watch;
    std::promise<MoveResult> promise;
  };

  void end(std::size_t move, MoveResult result, std::vector<Ended>& ended);

  HeldTargets& held_;
  std::vector<Move> moves_;
};

}  // namespace robot_client
}  // namespace rc10
