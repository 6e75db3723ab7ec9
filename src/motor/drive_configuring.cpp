#include "motor/drive_configuring.hpp"

#include <cmath>

namespace rc10 {
namespace {

constexpr int kSettingTries = 5;
// Flash wears: RAM may be written more often.
constexpr int kStoringTries = 3;
constexpr Duration kSettling = std::chrono::milliseconds{10};
constexpr Duration kSettingPatience = std::chrono::milliseconds{50};
// A drive at rest gets a frame in every tick or two. Without an answer for this time it no longer has
// this id, or is gone.
constexpr Duration kSilence = std::chrono::milliseconds{250};
// Damiao: 40 to 100 ms.
constexpr Duration kStoring = std::chrono::milliseconds{300};
// First try in silence: with kSettling half of a RobStride's restart_silence, so that a save frame which was
// lost costs no reference.
constexpr Duration kStoringInSilence = std::chrono::milliseconds{90};
constexpr double kSame = 1e-4;

}  // namespace

void DriveConfiguring::begin(const DriveWrite& write) noexcept {
  write_ = write;
  progress_ = Progress::kPending;
  phase_ = Phase::kWrite;
  index_ = 0;
  tries_ = 0;
  new_id_.reset();
  renamed_ = false;
  if (write_.count == 0) end(Progress::kDone);
}

bool DriveConfiguring::changesIdentity() const noexcept {
  return codec_.setup().settings[value().setting].identity;
}

bool DriveConfiguring::asWritten() const noexcept {
  return reading_ && std::fabs(*reading_ - value().value) <= kSame * std::fabs(value().value) + 1e-6;
}

void DriveConfiguring::onFrame(const CanFrame& frame) noexcept {
  if (phase_ == Phase::kEnded) return;
  heard_ = true;
  if (phase_ == Phase::kSaving) {
    saved_ = saved_ || codec_.saysSaved(frame);
  } else if (phase_ == Phase::kWritten || phase_ == Phase::kRead) {
    // Where reading() takes answers to a question, it takes none to a write.
    if (const auto reading = codec_.reading(value().setting, frame)) reading_ = reading;
  }
}

void DriveConfiguring::end(Progress progress) noexcept {
  progress_ = progress;
  phase_ = Phase::kEnded;
}

bool DriveConfiguring::wantsSilence() const noexcept {
  return codec_.setup().saves_in_silence && (phase_ == Phase::kSave || phase_ == Phase::kSaving);
}

bool DriveConfiguring::excusesSilence() const noexcept {
  if (phase_ == Phase::kSaving || phase_ == Phase::kUnsaved) return true;
  const bool written = phase_ == Phase::kWritten || phase_ == Phase::kRead;
  return wantsSilence() || (codec_.setup().stores_at_once && written && !changesIdentity());
}

void DriveConfiguring::rename() noexcept {
  renamed_ = true;
  if (codec_.idSetting() == value().setting) new_id_ = static_cast<int>(value().value);
}

void DriveConfiguring::enter(Phase phase, MonotonicTime now) noexcept {
  phase_ = phase;
  sent_at_ = now;
}

void DriveConfiguring::next(MonotonicTime now) noexcept {
  tries_ = 0;
  if (index_ + 1 < write_.count) {
    ++index_;
    phase_ = Phase::kWrite;
  } else if (write_.save && !codec_.setup().stores_at_once) {
    enter(Phase::kSave, now);
  } else {
    end(Progress::kDone);
  }
}

void DriveConfiguring::lookForReading(MonotonicTime now) noexcept {
  if (asWritten()) return next(now);
  if (changesIdentity()) {
    if (now - sent_at_ < kSilence) return;
    if (!heard_) {
      rename();
      return next(now);
    }
  } else if (!reading_ && now - sent_at_ < kSettingPatience) {
    return;
  }
  const int most = codec_.setup().stores_at_once ? kStoringTries : kSettingTries;
  if (tries_ < most) {
    phase_ = Phase::kWrite;
  } else {
    end(Progress::kNotConfirmed);
  }
}

void DriveConfiguring::lookForSaving(MonotonicTime now) noexcept {
  if (saved_) return end(Progress::kDone);
  const bool quick = codec_.setup().saves_in_silence && tries_ == 1;
  if (now - sent_at_ < (quick ? kStoringInSilence : kStoring)) return;
  // Under its new id it is not heard.
  if (renamed_) return end(Progress::kDone);
  if (tries_ < kStoringTries) {
    enter(Phase::kUnsaved, now);
    lookForLife(now);
  } else {
    end(Progress::kNotSaved);
  }
}

// A drive that is not heard takes no save frame either, and may be lost.
void DriveConfiguring::lookForLife(MonotonicTime now) noexcept {
  if (heard_) return enter(Phase::kSave, now);
  if (now - sent_at_ >= kSilence) end(Progress::kNotSaved);
}

void DriveConfiguring::look(MonotonicTime now) noexcept {
  switch (phase_) {
    case Phase::kWritten:
      if (!codec_.read(value().setting)) lookForReading(now);
      break;
    case Phase::kRead: lookForReading(now); break;
    case Phase::kSaving: lookForSaving(now); break;
    case Phase::kUnsaved: lookForLife(now); break;
    case Phase::kWrite:
    case Phase::kSave:
    case Phase::kEnded: break;
  }
}

std::size_t DriveConfiguring::pack(MonotonicTime now, std::span<CanFrame> out) noexcept {
  if (phase_ == Phase::kEnded || out.empty()) return 0;
  look(now);
  std::optional<CanFrame> frame;
  switch (phase_) {
    case Phase::kWrite:
      frame = codec_.write(value());
      phase_ = Phase::kWritten;
      ++tries_;
      break;
    case Phase::kWritten:
      if (now - sent_at_ < kSettling) return 0;
      frame = codec_.read(value().setting);
      if (frame) phase_ = Phase::kRead;
      break;
    case Phase::kSave:
      if (codec_.setup().saves_in_silence && now - sent_at_ < kSettling) return 0;
      frame = codec_.save(new_id_);
      phase_ = Phase::kSaving;
      ++tries_;
      break;
    case Phase::kRead:
    case Phase::kSaving:
    case Phase::kUnsaved:
    case Phase::kEnded: break;
  }
  if (!frame) return 0;
  sent_at_ = now;
  reading_.reset();
  heard_ = false;
  saved_ = false;
  out.front() = *frame;
  return 1;
}

}  // namespace rc10
