#include "drives/myactuator/myactuator_recogniser.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "drives/myactuator/myactuator_frames.hpp"

namespace rc10 {
namespace {

// Motion Protocol V4.2: every request but the restart (0x76) is answered under its code, and 0xF1 comes
// unasked.
constexpr std::array<std::uint8_t, 34> kMyactuatorAnswered{
    0x20, 0x30, 0x31, 0x32, 0x42, 0x43, 0x60, 0x61, 0x62, 0x63, 0x64, 0x70, 0x71, 0x77, 0x78, 0x80, 0x81,
    0x90, 0x92, 0x94, 0x9A, 0x9C, 0x9D, 0xA1, 0xA2, 0xA4, 0xA6, 0xA8, 0xB1, 0xB2, 0xB3, 0xB5, 0xB6, 0xF1};

}  // namespace

void recogniseMyactuator(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (frame.id.extended || frame.length != 8 || frame.fd) return;
  const auto within = [&](std::uint32_t base) {
    const int id = static_cast<int>(frame.id.value) - static_cast<int>(base);
    return id >= 1 && id <= myactuator::kMaxId ? id : 0;
  };
  if (const int id = within(myactuator::kReplyBase); id != 0) {
    const std::uint8_t code = frame.data[0];
    if (std::find(kMyactuatorAnswered.begin(), kMyactuatorAnswered.end(), code) != kMyactuatorAnswered.end())
      guesses.push_back({drive_kind::kMyactuator, id});
    return;
  }
  if (const int id = within(myactuator::kMotionReplyBase); id != 0 && frame.data[0] == id)
    guesses.push_back({drive_kind::kMyactuator, id});
}

}  // namespace rc10
