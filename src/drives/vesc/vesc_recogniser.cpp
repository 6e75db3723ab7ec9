#include "drives/vesc/vesc_recogniser.hpp"

#include "drives/vesc/vesc_frames.hpp"

namespace rc10 {

void recogniseVesc(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (!frame.id.extended || frame.fd || frame.id.value > 0xFFFF) return;
  const auto packet = static_cast<vesc::Packet>(frame.id.value >> 8U);
  const int id = static_cast<int>(frame.id.value & 0xFFU);
  switch (packet) {
    case vesc::Packet::kStatus1:
    case vesc::Packet::kStatus2:
    case vesc::Packet::kStatus3:
    case vesc::Packet::kStatus4:
    case vesc::Packet::kStatus5:
    case vesc::Packet::kStatus6:
      if (frame.length == vesc::kStatusLength) guesses.push_back({drive_kind::kVesc, id});
      return;
    case vesc::Packet::kPong:  // to who asked; the drive's id is the first byte
      if (frame.length >= 1) guesses.push_back({drive_kind::kVesc, frame.data[0]});
      return;
    case vesc::Packet::kSetDuty:
    case vesc::Packet::kSetCurrent:
    case vesc::Packet::kSetCurrentBrake:
    case vesc::Packet::kSetErpm:
    case vesc::Packet::kSetPosition:
      if (frame.length == 4) guesses.push_back({drive_kind::kVesc, id, false});
      return;
    default: return;
  }
}

}  // namespace rc10
