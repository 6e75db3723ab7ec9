#include "drives/lktech/lktech_recogniser.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "drives/lktech/lktech_frames.hpp"

namespace rc10 {
namespace {

// Protocol V2.35 and RMCS: each is answered under its code, the first four by a copy of the command.
constexpr std::array<std::uint8_t, 4> kLktechCopied{0x80, 0x81, 0x88, 0x8C};
constexpr std::array<std::uint8_t, 19> kLktechAnswered{0x90, 0x92, 0x94, 0x9A, 0x9B, 0x9C, 0x9D,
                                                       0xA0, 0xA1, 0xA2, 0xA3, 0xA4, 0xA5, 0xA6,
                                                       0xA7, 0xA8, 0xAD, 0xC0, 0xC1};

template <typename Codes>
bool isLktechCode(const Codes& codes, std::uint8_t code) {
  return std::find(codes.begin(), codes.end(), code) != codes.end();
}

}  // namespace

// Their commands have the same ids, and those of MyActuator are the same: what is no answer may be either's.
void recogniseLktech(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (frame.id.extended || frame.length != 8 || frame.fd) return;
  const int id = static_cast<int>(frame.id.value) - static_cast<int>(lktech::kBaseId);
  if (id < 1 || id > lktech::kMaxId) return;
  const bool copied = isLktechCode(kLktechCopied, frame.data[0]);
  if (!copied && !isLktechCode(kLktechAnswered, frame.data[0])) return;
  const bool command = lktech::looksLikeCommand(frame.payload());
  if (copied || !command) guesses.push_back({drive_kind::kLktech, id});
  if (command) guesses.push_back({drive_kind::kLktech, id, false});
  if (command) guesses.push_back({drive_kind::kMyactuator, id, false});
}

}  // namespace rc10
