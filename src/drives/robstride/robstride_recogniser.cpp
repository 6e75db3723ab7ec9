#include "drives/robstride/robstride_recogniser.hpp"

#include <string_view>

#include "drives/robstride/robstride_frames.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kRobstride = "RobStride or CyberGear";

}  // namespace

// The drive's id is in the second byte of the id, that of the host in the first.
void recogniseRobstride(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (!frame.id.extended || frame.fd || frame.length != 8) return;
  constexpr std::uint32_t kToAnyHost = 0xFE;  // the answer to the question for the id
  const auto type = static_cast<robstride::Type>(frame.id.value >> 24U);
  const int drive = static_cast<int>(frame.id.value >> 8U & 0xFFU);
  const bool answers =
      type == robstride::Type::kFeedback || type == robstride::Type::kReport ||
      type == robstride::Type::kFault ||
      (type == robstride::Type::kGetId && (frame.id.value & 0xFFU) == kToAnyHost && frame.id.value <= 0xFFFF);
  if (answers && drive != 0) guesses.push_back({kRobstride, drive});
  if (type == robstride::Type::kOperate)
    guesses.push_back({kRobstride, static_cast<int>(frame.id.value & 0xFFU), false});
}

}  // namespace rc10
