#include "drives/damiao/damiao_recogniser.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "drives/damiao/damiao_frames.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kDamiao = "Damiao";
// Above this a master id would be taken for a command to another drive of one of its modes.
constexpr std::uint32_t kDamiaoMasterMax = 0xFF;
// Manual, "LED Status": disabled, enabled, and from "calibration" to "overload".
constexpr std::array<std::uint8_t, 13> kDamiaoStatuses{0x0, 0x1, 0x2, 0x3, 0x4, 0x5, 0x8,
                                                       0x9, 0xA, 0xB, 0xC, 0xD, 0xE};

}  // namespace

bool speaksDamiao(const CanFrame& frame, int id) {
  const auto status = static_cast<std::uint8_t>(frame.data[0] >> 4U);
  return !frame.id.extended && frame.length == 8 && (frame.data[0] & 0x0F) == id &&
         std::find(kDamiaoStatuses.begin(), kDamiaoStatuses.end(), status) != kDamiaoStatuses.end();
}

void recogniseDamiao(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  const int id = frame.data[0] & 0x0F;
  if (frame.id.value <= kDamiaoMasterMax && id >= 1 && speaksDamiao(frame, id))
    guesses.push_back({kDamiao, id});
}

}  // namespace rc10
