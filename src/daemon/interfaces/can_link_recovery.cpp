#include "daemon/interfaces/can_link_recovery.hpp"

#include <algorithm>

namespace rc10 {

CanLinkRecovery::Step CanLinkRecovery::update(MonotonicTime now, BusState state) noexcept {
  const bool trouble = state == BusState::kBusOff || state == BusState::kStalled || state == BusState::kDown;
  if (trouble != in_trouble_) {
    in_trouble_ = trouble;
    tried_ = false;
    changed_ = now;
  }
  if (!trouble) {
    if (attempts_ > 0 && now - changed_ >= kWellAfter) {
      wait_ = kFirst;
      attempts_ = 0;
    }
    return {};
  }
  const auto since = attempts_ > 0 ? std::max(changed_, last_try_) : changed_;
  if (now - since < wait_) return {};
  const Step step{.due = true, .first = !tried_};
  tried_ = true;
  tried(now);
  return step;
}

void CanLinkRecovery::tried(MonotonicTime now) noexcept {
  last_try_ = now;
  wait_ = std::min(wait_ * 2, kLongest);
  ++attempts_;
}

}  // namespace rc10
