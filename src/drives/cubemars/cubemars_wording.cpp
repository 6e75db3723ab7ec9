#include "drives/cubemars/cubemars_wording.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "bus/byte_order.hpp"
#include "drives/cubemars/cubemars_frames.hpp"
#include "drives/cubemars/cubemars_model.hpp"

namespace rc10 {
namespace {

using cubemars::ServoCommand;

std::string cubemarsServoFeedback(const CanFrame& frame) {
  const int id = static_cast<int>(frame.id.value & 0xFFU);
  if (frame.id != cubemars::servoFeedbackId(id)) return {};
  const auto report = cubemars::readServoReport(frame);
  if (!report) return {};
  return FrameWords{id, "feedback"}
      .add("position", report->degrees, "deg")
      .add("velocity", report->erpm, "erpm")
      .add("current", report->amperes, "A")
      .add("temperature", report->temperature_c, "°C")
      .code("error", report->error)
      .take();
}

std::string cubemarsServoCommand(const CanFrame& frame) {
  constexpr std::array kNames{"duty",     "current",    "brake current",        "velocity",
                              "position", "set origin", "position and velocity"};
  const int id = static_cast<int>(frame.id.value & 0xFFU);
  const auto command = static_cast<ServoCommand>(frame.id.value >> 8U);
  if (command == ServoCommand::kMit) return FrameWords{id, "MIT command"}.take();
  const auto index = static_cast<std::size_t>(command);
  if (index >= kNames.size()) return {};
  FrameWords words{id, kNames[index]};
  if (frame.length >= 4) words.add("raw", readBigEndian<std::int32_t>(frame.payload(), 0));
  return words.take();
}

std::string cubemarsMitCommand(const CanFrame& frame) {
  const int id = static_cast<int>(frame.id.value);
  const auto payload = frame.payload();
  if (payload.size() != 8) return {};
  if (std::all_of(payload.begin(), payload.end() - 1, [](std::uint8_t byte) { return byte == 0xFF; })) {
    switch (static_cast<cubemars::MitOrder>(payload[7])) {
      case cubemars::MitOrder::kEnter: return FrameWords{id, "enter MIT mode"}.take();
      case cubemars::MitOrder::kExit: return FrameWords{id, "leave MIT mode"}.take();
      case cubemars::MitOrder::kZero: return FrameWords{id, "set zero"}.take();
    }
  }
  return FrameWords{id, "MIT command"}.take();
}

}  // namespace

std::string wordCubemars(const CanFrame& frame, std::string_view model, bool sent) {
  const auto* cubemars_model = findCubemarsModel(model);
  if (cubemars_model == nullptr || frame.fd) return {};
  if (frame.id.extended) return sent ? cubemarsServoCommand(frame) : cubemarsServoFeedback(frame);
  if (sent) return cubemarsMitCommand(frame);
  const auto report = cubemars::readMitReport(frame, cubemars_model->ranges);
  if (!report) return {};
  FrameWords words{report->motor_id, "MIT feedback"};
  words.add("position", report->position_rad, "rad")
      .add("velocity", report->velocity_rad_s, "rad/s")
      .add("torque", report->torque_nm, "Nm");
  if (report->temperature_c) words.add("temperature", *report->temperature_c, "°C");
  return words.code("error", report->error)
      .add("scale of the position", cubemars_model->ranges.position_rad, "rad")
      .take();
}

}  // namespace rc10
