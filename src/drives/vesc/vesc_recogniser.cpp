#include "drives/vesc/vesc_recogniser.hpp"

#include <array>

#include "drives/vesc/vesc_frames.hpp"

namespace rc10 {
namespace {

// The host's id is part of the safety: see survey/harmless_queries.hpp.
constexpr std::uint8_t kVescScanHost = 0xFE;
constexpr int kVescScanIds = 254;  // 254 is ours, 255 all of them
constexpr std::array<std::string_view, 1> kVescAsked{"VESC"};
constexpr std::array<std::string_view, 1> kVescMaybeSilent{"VESC as delivered"};
constexpr std::string_view kVescSilent =
    "in VESC Tool, App Settings, General: CAN Status Rate 1 = 100 Hz, CAN Status Messages 1 = Status 1 and "
    "Status 5; write the settings (docs/motors/vesc.md)";

std::vector<CanFrame> vescPings() {
  std::vector<CanFrame> pings;
  pings.reserve(kVescScanIds);
  const std::array<std::uint8_t, 1> who{kVescScanHost};
  for (int id = 0; id < kVescScanIds; ++id)
    pings.push_back(makeClassicFrame(vesc::canId(vesc::Packet::kPing, id), who));
  return pings;
}

}  // namespace

const ScanQuestions& vescQuestions() noexcept {
  static constexpr ScanQuestions kQuestions{
      .asked = kVescAsked, .silent = kVescMaybeSilent, .frames = vescPings};
  return kQuestions;
}

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
      if (frame.length >= 1) {
        guesses.push_back({.kind = drive_kind::kVesc, .id = frame.data[0], .silent = kVescSilent});
      }
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
