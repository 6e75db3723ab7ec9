#include "survey/scan_advice.hpp"

#include <algorithm>

#include "drives/vesc/vesc_frames.hpp"

namespace rc10::survey {
namespace {

bool isPong(CanId id) {
  return id.extended && id.value >> 8U == static_cast<std::uint32_t>(vesc::Packet::kPong);
}

bool isVesc(const Sighting& sighting, int id) {
  return !sighting.ambiguous() &&
         std::any_of(sighting.guesses.begin(), sighting.guesses.end(), [id](const DriveGuess& guess) {
           return guess.kind == drive_kind::kVesc && guess.from_drive && guess.id == id;
         });
}

}  // namespace

bool isSilentVesc(const Sighting& sighting, const std::vector<Sighting>& all) {
  if (!isPong(sighting.id) || sighting.guesses.empty() || sighting.ambiguous()) return false;
  const int id = sighting.guesses.front().id;
  return isVesc(sighting, id) && std::none_of(all.begin(), all.end(), [id](const Sighting& other) {
           return !isPong(other.id) && isVesc(other, id);
         });
}

std::string adviceFor(const Sighting& sighting, const std::vector<Sighting>& all) {
  if (sighting.guesses.empty()) return "no family that rc10d knows";
  if (sighting.ambiguous()) return "Look at its label, or unplug it and scan again";
  if (!isSilentVesc(sighting, all)) return {};
  return "VESC id " + std::to_string(sighting.guesses.front().id) +
         " answers but sends no status: in VESC Tool, App Settings, General: CAN Status Rate 1 = 100 Hz, CAN "
         "Status Messages 1 = Status 1 and Status 5; write the settings (docs/motors/vesc.md)";
}

std::vector<std::string> adviceForBus(const std::vector<Sighting>& all, const Asking& asking) {
  std::vector<std::string> advice;
  if (all.empty()) {
    advice.emplace_back(
        "nothing was heard: check the drives' power, the wiring, the termination and the bit rate: `rc10ctl "
        "doctor`");
  }
  for (const int node : asking.spared) {
    advice.push_back(
        "not all VESC, RobStride and CyberGear ids were asked: an ODrive with extended ids, node " +
        std::to_string(node) + ", would take the questions for commands");
  }
  advice.emplace_back(
      "Damiao, LK-Tech, MyActuator and moteus drives speak only when they are asked, and are not asked here: "
      "a question to one family may be a command to another. Take their ids from their labels or tools.");
  if (asking.listen_only) {
    advice.emplace_back(
        "Nothing was asked (--listen-only): VESC as delivered, RobStride and CyberGear may be silent too.");
  }
  return advice;
}

}  // namespace rc10::survey
