#include "drives/moteus/moteus_recogniser.hpp"

#include <string_view>

#include "drives/moteus/moteus_frames.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kMoteus = "moteus";

bool isMoteusAnswer(const CanFrame& frame) {
  moteus::Reader reader(frame.payload());
  bool answered = false;
  for (;;) {
    moteus::Item item;
    const auto step = reader.next(item);
    if (step == moteus::Reader::Step::kMalformed) return false;
    if (step == moteus::Reader::Step::kEnd) return answered;
    if (item.kind != moteus::Item::Kind::kReply && item.kind != moteus::Item::Kind::kError) return false;
    answered = true;
  }
}

}  // namespace

void recogniseMoteus(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (!frame.fd || !isMoteusAnswer(frame)) return;
  const std::uint32_t prefix = frame.id.value >> 16U;
  const std::uint32_t id = frame.id.value >> 8U & 0x7FU;
  if (frame.id == moteus::replyId(prefix, id)) guesses.push_back({kMoteus, static_cast<int>(id)});
}

}  // namespace rc10
