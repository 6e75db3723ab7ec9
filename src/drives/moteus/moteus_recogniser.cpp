#include "drives/moteus/moteus_recogniser.hpp"

#include <string_view>

#include "drives/moteus/moteus_frames.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kMoteus = "moteus";

bool isMoteusAnswer(const CanFrame& frame) {
  MoteusReader reader(frame.payload());
  bool answered = false;
  for (;;) {
    MoteusItem item;
    const auto step = reader.next(item);
    if (step == MoteusReader::Step::kMalformed) return false;
    if (step == MoteusReader::Step::kEnd) return answered;
    if (item.kind != MoteusItem::Kind::kReply && item.kind != MoteusItem::Kind::kError) return false;
    answered = true;
  }
}

}  // namespace

void recogniseMoteus(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (!frame.fd || !isMoteusAnswer(frame)) return;
  const std::uint32_t prefix = frame.id.value >> 16U;
  const std::uint32_t id = frame.id.value >> 8U & 0x7FU;
  if (frame.id == moteusReplyId(prefix, id)) guesses.push_back({kMoteus, static_cast<int>(id)});
}

}  // namespace rc10
