#include "drives/myactuator/myactuator_recogniser.hpp"

#include "drives/myactuator/myactuator_frames.hpp"

namespace rc10 {

void recogniseMyactuator(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (frame.id.extended || frame.length != 8 || frame.fd) return;
  using myactuator::Code;
  const auto within = [&](std::uint32_t base) {
    const int id = static_cast<int>(frame.id.value) - static_cast<int>(base);
    return id >= 1 && id <= myactuator::kMaxId ? id : 0;
  };
  if (const int id = within(myactuator::kReplyBase); id != 0) {
    switch (myactuator::codeOf(frame.payload())) {
      case Code::kStatus:
      case Code::kReading:
      case Code::kCurrent:
      case Code::kVelocity:
      case Code::kPosition:
      case Code::kAngle:
      case Code::kUptime:
      case Code::kShutdown:
      case Code::kSilenceStopped: guesses.push_back({drive_kind::kMyactuator, id}); return;
      default: return;
    }
  }
  if (const int id = within(myactuator::kMotionReplyBase); id != 0 && frame.data[0] == id)
    guesses.push_back({drive_kind::kMyactuator, id});
}

}  // namespace rc10
