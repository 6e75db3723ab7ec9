#include "drives/robstride/robstride_recogniser.hpp"

#include <array>
#include <optional>
#include <string_view>

#include "drives/robstride/robstride_frames.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kRobstride = "RobStride or CyberGear";
// The host's id is part of the safety: see survey/harmless_queries.hpp.
constexpr std::uint32_t kRobstrideScanHost = 0xFD;
constexpr std::uint32_t kRobstrideScanIds = 127;
constexpr std::uint32_t kToAnyHost = 0xFE;  // the answer to the question for the id
constexpr std::array<std::string_view, 2> kRobstrideAsked{"RobStride", "CyberGear"};

std::vector<CanFrame> robstrideIdQuestions() {
  std::vector<CanFrame> questions;
  const std::array<std::uint8_t, 8> nothing{};
  for (std::uint32_t id = 1; id <= kRobstrideScanIds; ++id)
    questions.push_back(makeClassicFrame(
        robstride::canId(robstride::Type::kGetId, kRobstrideScanHost, static_cast<int>(id)), nothing));
  return questions;
}

// Type 0 is what it asks, whoever is the host: it answers to 0xFE, and in the byte of a packet stands its own
// id. To a VESC or CubeMars drive with id 254 that is a command: of id 1 a current, of 3 a speed.
std::optional<CanId> robstrideAnswer(CanId question) {
  const std::uint32_t drive = question.value & 0xFFU;
  if (!question.extended || question.value > 0xFFFFFFU || drive == 0 || drive > kRobstrideScanIds)
    return std::nullopt;
  return CanId{drive << 8U | kToAnyHost, true};
}

}  // namespace

const ScanQuestions& robstrideQuestions() noexcept {
  static constexpr ScanQuestions kQuestions{.asked = kRobstrideAsked,
                                            .silent = kRobstrideAsked,
                                            .frames = robstrideIdQuestions,
                                            .answer = robstrideAnswer};
  return kQuestions;
}

// The drive's id is in the second byte of the id, that of the host in the first.
void recogniseRobstride(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (!frame.id.extended || frame.fd || frame.length != 8) return;
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
