#include "drives/vesc/vesc_inquiry.hpp"

#include <utility>

namespace rc10 {
namespace {

using std::chrono::milliseconds;

// A fault shows for at least the 500 ms of MCCONF_M_FAULT_STOP_TIME: asked for every 200 ms it is not missed.
constexpr Duration kAskEvery = milliseconds{100};
constexpr Duration kAskOften = milliseconds{50};  // while somebody waits for it
constexpr int kMaxUnanswered = 5;
constexpr std::uint32_t kAll = vesc::kAskFault | vesc::kAskStatus;
// Time of rest before the silence, and of a drive to hear us.
constexpr Duration kRestFirst = milliseconds{100};
constexpr Duration kMustHaveHeard = milliseconds{300};

bool obeys(FrameKind kind) noexcept { return dutyOf(kind) == DriveDuty::kObey; }

}  // namespace

void VescInquiry::update(const Tick& tick, FrameKind ordered) noexcept {
  now_ = tick.now;
  if (!begun_ || ordered != ordered_) {
    if (!begun_ || obeys(ordered_) != obeys(ordered)) ordered_since_ = tick.now;
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

bool VescInquiry::deaf() const noexcept { return deaf_ || ignored_ > kMaxUnanswered; }

bool VescInquiry::proving() const noexcept { return proof_ == Proof::kOpen && heard_ && !obeys(ordered_); }

void VescInquiry::watchSilence(const Tick& tick) noexcept {
  if (!proving()) {
    silent_ = false;
    return;
  }
  if (silent_) {
    // Asked twice more after it should have tripped.
    silent_ = tick.now - silent_since_ <= silent_for_ + 3 * kAskEvery;
    if (!silent_) proof_ = Proof::kRefuted;
    return;
  }
  const Duration rested = tick.now - ordered_since_;
  if (heard_us_at_ && tick.now - *heard_us_at_ <= kMustHaveHeard) {
    silent_ = rested >= kRestFirst;
    silent_since_ = tick.now;
  } else if (ordered_ == FrameKind::kEnable && told_ && rested > kMustHaveHeard && fresh_ == kAll) {
    proof_ = Proof::kRefuted;  // told to rest, and it says that it was told nothing
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
  } else if (fresh_ == kAll && proof_ == Proof::kProven) {
    progress_ = fault_ == 0 && !killed() ? SequenceProgress::kDone : SequenceProgress::kFailed;
  }
}

void VescInquiry::ask(const Tick& tick) noexcept {
  question_ = 0;
  const bool enabling = ordered_ == FrameKind::kEnable && progress_ == SequenceProgress::kPending;
  const Duration every = enabling || proving() ? kAskOften : kAskEvery;
  const bool answered = pending_ == 0;
  // While enabling the second question follows the answer to the first at once.
  const bool hurry = enabling && answered && (fresh_ & next_) == 0;
  if (!hurry && tick.now - asked_ < every) return;
  if (!answered) {
    ++unanswered_;
    // Silence both ways is no sign of deafness: a cut cable, a pause.
    if (spoke_) ++ignored_;
  }
  spoke_ = false;
  question_ = next_;
  pending_ = next_;
  next_ = next_ == vesc::kAskStatus ? vesc::kAskFault : vesc::kAskStatus;
  asked_ = tick.now;
}

void VescInquiry::take(const vesc::Answer& answer) noexcept {
  if (!std::exchange(heard_, true)) ordered_since_ = now_;
  ignored_ = 0;
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
  deaf_ = timed_out && obeys(ordered_) && now_ - ordered_since_ >= kMustHaveHeard;
  heard_us_at_ = timed_out || !told_ ? std::nullopt : std::optional{now_};
  if (timed_out && silent_) {
    proof_ = Proof::kProven;
    silent_ = false;
  }
}

void VescInquiry::restart() noexcept {
  proof_ = Proof::kOpen;
  heard_ = false;
  told_ = false;
  heard_us_at_.reset();
  silent_ = false;
  deaf_ = false;
  ignored_ = 0;
  fault_ = 0;
  status_ = 0;
  pending_ = 0;
}

}  // namespace rc10
