#include "drives/vesc/vesc_recogniser.hpp"

#include "drives/vesc/vesc_frames.hpp"

namespace rc10 {

void recogniseVesc(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (!frame.id.extended || frame.fd || frame.id.value > 0xFFFF) return;
  const auto packet = static_cast<VescPacket>(frame.id.value >> 8U);
  const int id = static_cast<int>(frame.id.value & 0xFFU);
  switch (packet) {
    case VescPacket::kStatus1:
    case VescPacket::kStatus2:
    case VescPacket::kStatus3:
    case VescPacket::kStatus4:
    case VescPacket::kStatus5:
    case VescPacket::kStatus6:
      if (frame.length == kVescStatusLength) guesses.push_back({drive_kind::kVesc, id});
      return;
    case VescPacket::kPong:  // to who asked; the drive's id is the first byte
      if (frame.length >= 1) guesses.push_back({drive_kind::kVesc, frame.data[0]});
      return;
    case VescPacket::kSetDuty:
    case VescPacket::kSetCurrent:
    case VescPacket::kSetCurrentBrake:
    case VescPacket::kSetErpm:
    case VescPacket::kSetPosition:
      if (frame.length == 4) guesses.push_back({drive_kind::kVesc, id, false});
      return;
    default: return;
  }
}

}  // namespace rc10
