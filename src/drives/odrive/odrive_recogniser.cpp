#include "drives/odrive/odrive_recogniser.hpp"

#include <cmath>

#include "drives/odrive/odrive_frames.hpp"

namespace rc10 {
namespace {

constexpr std::uint8_t kOdriveLastState = 14;
// Heartbeats come every 100 ms, or at a rate that somebody has set. Feedback of a DJI motor at rest looks
// the same and comes 1000 times a second.
constexpr float kMostHeartbeatsHz = 150.0F;

/// Numbers that a shaft can have: bytes of another protocol read as floats are seldom.
bool sane(float value) {
  return std::isfinite(value) && (value == 0.0F || (std::abs(value) > 1e-9F && std::abs(value) < 1e7F));
}

/// Messages beside its estimates. 0x15 and 0x1C have another meaning in firmware 0.5, with numbers of the
/// same kind.
bool isTelemetry(odrive::Message message, const CanFrame& frame) {
  const auto pair = odrive::decodePair(frame);
  if (!pair) return false;
  constexpr float kLowestV = 5.0F;
  constexpr float kHighestV = 100.0F;
  switch (message) {
    case odrive::Message::kIq:
    case odrive::Message::kTorques: return sane(pair->first) && sane(pair->second);
    // A motor without a sensor has no number.
    case odrive::Message::kTemperature:
      return sane(pair->first) && (std::isnan(pair->second) || sane(pair->second));
    case odrive::Message::kBusVoltage:
      return pair->first > kLowestV && pair->first < kHighestV && sane(pair->second);
    default: return false;
  }
}

void addStandard(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (frame.id.extended || frame.fd) return;
  const int node = static_cast<int>(frame.id.value >> odrive::kMessageBits);
  const auto message = odrive::messageOf(frame.id);
  if (message == odrive::Message::kHeartbeat) {
    const auto beat = odrive::decodeHeartbeat(frame);
    if (beat && static_cast<std::uint8_t>(beat->state) <= kOdriveLastState)
      guesses.push_back({.kind = drive_kind::kOdrive, .id = node, .most_hz = kMostHeartbeatsHz});
  }
  if (message == odrive::Message::kEncoderEstimates) {
    const auto pair = odrive::decodePair(frame);
    if (pair && sane(pair->first) && sane(pair->second)) guesses.push_back({drive_kind::kOdrive, node});
  }
  if (isTelemetry(message, frame)) guesses.push_back({drive_kind::kOdrive, node});
}

// Other families have such ids. The heartbeat tells them apart: an axis is in a state from "idle" on, and
// bytes 5 and 6 are a code and a flag. A VESC or CubeMars at rest has zeros there.
void addExtended(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  constexpr std::uint8_t kHighestCode = 15;
  if (!frame.id.extended || odrive::messageOf(frame.id) != odrive::Message::kHeartbeat) return;
  const auto beat = odrive::decodeHeartbeat(frame);
  if (!beat || beat->byte5 > kHighestCode || beat->byte6 > kHighestCode) return;
  const auto state = static_cast<std::uint8_t>(beat->state);
  if (state >= static_cast<std::uint8_t>(odrive::AxisState::kIdle) && state <= kOdriveLastState)
    guesses.push_back({.kind = drive_kind::kOdriveExtended,
                       .id = static_cast<int>(frame.id.value >> odrive::kMessageBits),
                       .most_hz = kMostHeartbeatsHz});
}

}  // namespace

void recogniseOdrive(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  addStandard(frame, guesses);
  addExtended(frame, guesses);
}

std::optional<Obeying> odriveObeying(CanId question) {
  if (!question.extended) return std::nullopt;
  const std::uint32_t node = question.value >> odrive::kMessageBits;
  const std::uint32_t heartbeat =
      node << odrive::kMessageBits | static_cast<std::uint32_t>(odrive::Message::kHeartbeat);
  return Obeying{.drive = {drive_kind::kOdriveExtended, static_cast<int>(node)},
                 .shown = {heartbeat, true},
                 .name = "an ODrive with extended ids, node"};
}

}  // namespace rc10
