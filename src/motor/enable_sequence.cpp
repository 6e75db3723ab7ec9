#include "motor/enable_sequence.hpp"

namespace rc10 {

void EnableRhythm::restart() noexcept {
  progress_ = SequenceProgress::kPending;
  asked_ = 0;
}

bool EnableRhythm::exhausted(MonotonicTime now) const noexcept {
  return pending() && asked_ >= tries_ && now - asked_last_ >= patience_;
}

bool EnableRhythm::asks(MonotonicTime now) noexcept {
  if (!pending() || (asked_ > 0 && now - asked_last_ < patience_)) return false;
  if (asked_ >= tries_) {
    fail();
    return false;
  }
  if (asked_++ == 0) asked_first_ = now;
  asked_last_ = now;
  return true;
}

}  // namespace rc10
