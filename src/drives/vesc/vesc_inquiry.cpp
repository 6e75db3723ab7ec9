#include "drives/vesc/vesc_inquiry.hpp"

namespace rc10 {
namespace {

using std::chrono::milliseconds;

// A fault shows for at least the 500 ms of MCCONF_M_FAULT_STOP_TIME: asked for every 200 ms it is not missed.
constexpr Duration kAskEvery = milliseconds{100};
constexpr Duration kAskWhileEnabling = milliseconds{50};
constexpr int kMaxUnanswered = 5;
// Time of rest before the silence, and of an enabled drive to hear us.
constexpr Duration kRestFirst = milliseconds{100};
constexpr Duration kMustHaveHeard = milliseconds{300};

bool atRest(FrameKind kind) noexcept { return dutyOf(kind) == DriveDuty::kRest; }

}  // namespace

void VescInquiry::update(const Tick& tick, FrameKind ordered) noexcept {
  now_ = tick.now;
  if (!begun_ || ordered != ordered_) {
    const bool rested = atRest(ordered_) && atRest(ordered);
    if (!begun_ || !rested) ordered_since_ = tick.now;
    if (ordered == FrameKind::kEnable) {
      progress_ = SequenceProgress::kPending;
      fresh_ = 0;
      unanswered_ = 0;
      asked_ = tick.now - kAskEvery;
    }
    begun_ = true;
    ordered_ = ordered;
  }
  watchSilence(tick);
  if (ordered == FrameKind::kEnable) enable();
  ask(tick);
}

void VescInquiry::watchSilence(const Tick& tick) noexcept {
  const bool may = dutyOf(ordered_) != DriveDuty::kObey;
  if (!may || proof_ != Proof::kOpen || !heard_) {
    silent_ = false;
    return;
  }
  if (!silent_) {
    const bool rested = ordered_ == FrameKind::kEnable || tick.now - ordered_since_ >= kRestFirst;
    if (!rested) return;
    silent_ = true;
    silent_since_ = tick.now;
  }
  // Asked twice more after it should have tripped.
  if (tick.now - silent_since_ > silent_for_ + 3 * kAskEvery) {
    proof_ = Proof::kRefuted;
    silent_ = false;
  }
}

// No EnableSequence: it asks all the time, and enabling only waits for answers that are fresh.
void VescInquiry::enable() noexcept {
  if (progress_ != SequenceProgress::kPending) return;
  if (proof_ == Proof::kRefuted) {
    // Told now; looked at again while at rest.
    proof_ = Proof::kOpen;
    progress_ = SequenceProgress::kFailed;
  } else if (unanswered_ > kMaxUnanswered) {
    progress_ = SequenceProgress::kFailed;
  } else if (fresh_ == (vesc::kAskFault | vesc::kAskStatus) && proof_ == Proof::kProven) {
    progress_ = fault_ == 0 && !killed() ? SequenceProgress::kDone : SequenceProgress::kFailed;
  }
}

void VescInquiry::ask(const Tick& tick) noexcept {
  question_ = 0;
  const bool enabling = ordered_ == FrameKind::kEnable && progress_ == SequenceProgress::kPending;
  const Duration every = enabling ? kAskWhileEnabling : kAskEvery;
  const bool answered = pending_ == 0;
  // While enabling the second question follows the answer to the first at once.
  const bool hurry = enabling && answered && (fresh_ & next_) == 0;
  if (!hurry && tick.now - asked_ < every) return;
  if (!answered) ++unanswered_;
  question_ = next_;
  pending_ = next_;
  next_ = next_ == vesc::kAskStatus ? vesc::kAskFault : vesc::kAskStatus;
  asked_ = tick.now;
}

void VescInquiry::take(const vesc::Answer& answer) noexcept {
  heard_ = true;
  fresh_ |= answer.mask;
  if (answer.mask == pending_) {
    pending_ = 0;
    unanswered_ = 0;
  }
  if (answer.mask == vesc::kAskFault) {
    fault_ = answer.value;
    return;
  }
  status_ = answer.value;
  const bool timed_out = (answer.value & vesc::kTimedOut) != 0;
  const bool commanded = dutyOf(ordered_) == DriveDuty::kObey;
  deaf_ = timed_out && commanded && now_ - ordered_since_ >= kMustHaveHeard;
  if (timed_out) {
    proof_ = Proof::kProven;
    silent_ = false;
  }
}

void VescInquiry::restart() noexcept {
  proof_ = Proof::kOpen;
  heard_ = false;
  silent_ = false;
  deaf_ = false;
  fault_ = 0;
  status_ = 0;
  pending_ = 0;
}

}  // namespace rc10
