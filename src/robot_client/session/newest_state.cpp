#include "robot_client/session/newest_state.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using std::chrono::milliseconds;

// Without a younger state nothing is held.
constexpr Duration kLive = milliseconds{1000};
// A state that is older than the known one by less than this has been overtaken; by more, rc10d's computer
// has started anew.
constexpr std::int64_t kOvertakenUs = 1'000'000;

}  // namespace

bool NewestState::take(const std::shared_ptr<RobotState>& state, MonotonicTime now, bool last) {
  const auto overtaken_us = state_ ? state_->mono_us - state->mono_us : 0;
  if (0 < overtaken_us && overtaken_us < kOvertakenUs) return false;
  state->taken = clock_.observe(std::chrono::microseconds{state->mono_us}, now, last);
  state_ = state;
  ++received_;
  return true;
}

bool NewestState::live(MonotonicTime now) const noexcept {
  // By its own time: after a pause of this program an old one comes out of the socket's queue.
  return state_ && now <= state_->taken + kLive;
}

}  // namespace robot_client
}  // namespace rc10
