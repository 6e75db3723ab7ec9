#pragma once

#include <cstdint>
#include <memory>

#include "rc10/robot_state.hpp"
#include "robot_client/session/host_clock.hpp"

namespace rc10 {
inline namespace robot_client {

/// The newest state of a robot, and whether it is new. Pure.
class NewestState {
 public:
  /// False: another one overtook it on its way. Sets RobotState::taken. `last`: no message waits behind it.
  [[nodiscard]] bool take(const std::shared_ptr<RobotState>& state, MonotonicTime now, bool last = true);

  /// nullptr before the first.
  [[nodiscard]] const std::shared_ptr<const RobotState>& get() const noexcept { return state_; }
  /// Whether it proves that rc10d runs and is heard.
  [[nodiscard]] bool live(MonotonicTime now) const noexcept;
  [[nodiscard]] std::uint64_t received() const noexcept { return received_; }

 private:
  HostClock clock_;
  std::shared_ptr<const RobotState> state_;
  std::uint64_t received_ = 0;
};

}  // namespace robot_client
}  // namespace rc10
