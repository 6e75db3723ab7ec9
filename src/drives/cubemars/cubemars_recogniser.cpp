#include "drives/cubemars/cubemars_recogniser.hpp"

#include <string_view>

#include "drives/cubemars/cubemars_frames.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kCubemarsServo = "CubeMars (servo)";

}  // namespace

void recogniseCubemars(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (frame.fd) return;
  const int id = static_cast<int>(frame.id.value & 0xFFU);
  if (frame.id.extended && frame.id == cubemars::servoFeedbackId(id) && cubemars::readServoReport(frame))
    guesses.push_back({kCubemarsServo, id});
  // To the host 0, or to its own id; 6 bytes from the oldest firmware.
  const int told = frame.data[0];
  const bool to_host = frame.id.value == 0 || static_cast<int>(frame.id.value) == told;
  if (!frame.id.extended && to_host && told != 0 && (frame.length == 8 || frame.length == 6))
    guesses.push_back({drive_kind::kCubemarsMit, told});
}

}  // namespace rc10
