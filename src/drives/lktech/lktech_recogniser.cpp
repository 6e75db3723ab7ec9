#include "drives/lktech/lktech_recogniser.hpp"

#include <span>

#include "drives/lktech/lktech_frames.hpp"

namespace rc10 {
namespace {

bool isLkTechAnswer(std::span<const std::uint8_t> payload) {
  using lktech::Code;
  switch (lktech::codeOf(payload)) {
    case Code::kStatus:
    case Code::kClear:
    case Code::kReading:
    case Code::kCurrent:
    case Code::kVelocity:
    case Code::kPosition:
    case Code::kAngle: return true;
    default: return false;
  }
}

}  // namespace

// Their commands have the same ids, and those of MyActuator are the same: what is no answer may be either's.
void recogniseLktech(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (frame.id.extended || frame.length != 8 || frame.fd) return;
  const int id = static_cast<int>(frame.id.value) - static_cast<int>(lktech::kBaseId);
  if (id < 1 || id > lktech::kMaxId || !isLkTechAnswer(frame.payload())) return;
  const bool command = lktech::looksLikeCommand(frame.payload());
  guesses.push_back({drive_kind::kLktech, id, !command});
  if (command) guesses.push_back({drive_kind::kMyactuator, id, false});
}

}  // namespace rc10
