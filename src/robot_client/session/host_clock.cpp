#include "robot_client/session/host_clock.hpp"

#include <algorithm>
#include <chrono>

namespace rc10 {
inline namespace robot_client {
namespace {

// Two crystals differ by less than 100 us/s; without the allowance a slower host clock would make every later
// state look older than it is.
constexpr int kDriftDivider = 10'000;

// A host's clock that went back this far belongs to another boot or another host.
constexpr Duration kRestart = std::chrono::seconds{1};

// Lateness that no queue explains: without a gap, for so long, with nothing behind it.
constexpr Duration kLate = std::chrono::milliseconds{500};
constexpr Duration kGap = std::chrono::milliseconds{500};
constexpr Duration kBelieved = std::chrono::seconds{5};

}  // namespace

MonotonicTime HostClock::observe(Duration host, MonotonicTime local, bool last) noexcept {
  const Duration distance = local.time_since_epoch() - host;
  if (!distance_ || host < last_host_ - kRestart) {
    distance_ = distance;
    late_since_.reset();
  } else {
    distance_ = std::min(distance, *distance_ + (local - last_local_) / kDriftDivider);
    if (distance - *distance_ < kLate || local - last_local_ > kGap)
      late_since_.reset();
    else if (!last) {
      // It may have waited.
    } else if (!late_since_) {
      late_since_ = local;
      least_ = distance;
    } else if (least_ = std::min(least_, distance); local - *late_since_ >= kBelieved) {
      distance_ = least_;
      late_since_.reset();
    }
  }
  last_host_ = host;
  last_local_ = local;
  return MonotonicTime{host + *distance_};
}

}  // namespace robot_client
}  // namespace rc10
