// Arbitrary frames, orders and targets to VESC motors: whatever comes, readings are finite or not reported,
// angles in [0, 360), and every frame that is sent is a command of 4 bytes within its limits, or a question.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "bus/byte_order.hpp"
#include "drives/vesc/vesc_family.hpp"
#include "drives/vesc/vesc_motor.hpp"
#include "motor_orders.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr double kLimitA = 12.0;
constexpr double kLimitRpm = 900.0;
constexpr int kPolePairs = 7;

MotorSettings settings(int id, const char* angle, const char* stop, bool relative, double handbrake_a) {
  MotorSettings result;
  result.name = "vesc";
  result.model = "VESC";
  result.id = id;
  result.direction = id % 2 == 0 ? -1 : 1;
  result.gear_ratio = 3.0;
  result.effort_limit = static_cast<float>(kLimitA);
  result.velocity_limit_rpm = static_cast<float>(kLimitRpm);
  result.feedback_hz = 100;
  const auto number = [&result](const char* key, double value) { result.own.set(key, value); };
  number("pole_pairs", kPolePairs);
  number("position_divider", 3.0);
  number("speed_ramp_erpm_per_s", 25'000.0);
  number("motor_current_max_a", 60.0);
  number("relative_current", relative ? 1.0 : 0.0);
  number("brake_current_a", 10.0);
  number("handbrake_current_a", handbrake_a);
  number("kv_rpm_per_v", 100.0);
  number("supply_v", 24.0);
  number("ask_status", id == 3 ? 0.0 : 1.0);
  number("host_id", 253.0);
  result.own.set("angle", std::string{angle});
  result.own.set("velocity_zero", std::string{stop});
  result.own.set("temperature", std::string{"motor"});
  const auto traits = vescFamily().traits("VESC", result.own);
  if (traits.host_loops != nullptr) result.loops = *traits.host_loops;
  require(vescFamily().check(result).has_value());
  return result;
}

void checkReadings(const VESC_Motor& motor) {
  const MotorFeedback& feedback = motor.feedback();
  for (const float reading : {feedback.velocity_rpm, feedback.current_a, feedback.torque_nm,
                              feedback.voltage_v, feedback.temperature_c}) {
    require(!std::isinf(reading));
  }
  require(std::isnan(feedback.angle_deg) || (feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F));
  require(!std::isinf(feedback.total_angle_deg));
  require(std::isfinite(motor.commandValue()) || motor.commandUnit() == CommandUnit::kNative);
  const DriveComplaint complaint = motor.complaint();
  require(static_cast<std::int32_t>(complaint.fault) <= 47);
}

void checkFrame(const CanFrame& frame, int id) {
  require(frame.id.extended && !frame.fd && (frame.id.value & 0xFFU) == static_cast<std::uint32_t>(id));
  const auto packet = static_cast<vesc::Packet>(frame.id.value >> 8U);
  if (packet == vesc::Packet::kProcessShortBuffer) {
    require(frame.length == 7);
    return;
  }
  require(frame.length == 4);
  const auto raw = static_cast<double>(readBigEndian<std::int32_t>(frame.payload(), 0));
  switch (packet) {
    case vesc::Packet::kSetCurrent: require(std::abs(raw) <= kLimitA * 1e3); break;
    case vesc::Packet::kSetCurrentBrake:
    case vesc::Packet::kSetHandbrake: require(raw >= 0.0 && raw <= kLimitA * 1e3); break;
    case vesc::Packet::kSetCurrentRelative: require(std::abs(raw) <= kLimitA / 60.0 * 1e5); break;
    case vesc::Packet::kSetCurrentBrakeRelative:
    case vesc::Packet::kSetHandbrakeRelative: require(raw >= 0.0 && raw <= kLimitA / 60.0 * 1e5); break;
    case vesc::Packet::kSetErpm: require(std::abs(raw) <= kLimitRpm * 3.0 * kPolePairs + 1.0); break;
    case vesc::Packet::kSetDuty: require(std::abs(raw) <= 1e5); break;
    case vesc::Packet::kSetPosition: require(raw >= 0.0 && raw <= 360e6); break;
    default: require(false);
  }
}

CanFrame takeFrame(Input& input) {
  constexpr std::array<std::uint8_t, 8> kPackets{9, 14, 15, 16, 27, 58, 57, 8};
  CanFrame frame;
  const auto head = input.take<std::uint32_t>();
  const std::uint32_t packet = kPackets[head & 7U];
  const std::uint32_t id = packet == 8 ? 253U : (head >> 3U) & 7U;
  frame.id = {packet << 8U | id, (head & 0x1000U) == 0};
  frame.fd = (head & 0x2000U) != 0 && (head & 0x8000U) != 0;
  frame.type = (head & 0x4000U) != 0 && (head & 0x8000U) != 0 ? FrameType::kRemote : FrameType::kData;
  const auto odd = static_cast<std::uint8_t>((head >> 16U) & 0x0FU);
  frame.length = odd < 9 ? std::uint8_t{8} : static_cast<std::uint8_t>(odd - 8U);
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = input.take<std::uint8_t>();
  return frame;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  VESC_Motor tachometer(settings(1, "tachometer", "regulate", false, 0.0));
  VESC_Motor encoder(settings(2, "encoder", "brake", true, 8.0));
  VESC_Motor neither(settings(3, "none", "coast", false, 20.0));
  const std::array<VESC_Motor*, 3> motors{&tachometer, &encoder, &neither};

  Input input(data, size);
  Tick tick{.index = 0, .now = MonotonicTime{std::chrono::hours{1}}};
  while (!input.empty()) {
    const auto action = input.take<std::uint8_t>();
    VESC_Motor& motor = *motors[action % motors.size()];
    if (!fuzz::giveOrder(motor, input, action >> 2U)) {
      CanFrame frame = takeFrame(input);
      tick.now += Duration{input.take<std::int32_t>()};
      frame.received = tick.now;
      for (VESC_Motor* each : motors) {
        if (each->matchesFrame(frame)) (void)each->updateFeedback(frame);
      }
    }
    ++tick.index;
    tick.now += std::chrono::milliseconds{1};
    int id = 0;
    for (VESC_Motor* each : motors) {
      ++id;
      each->update(tick);
      checkReadings(*each);
      std::array<CanFrame, kMaxFramesPerPacker> out{};
      const auto count = each->packCommand(tick, out);
      for (std::size_t i = 0; i < count; ++i) checkFrame(out[i], id);
      require(each->packRest(out) == 1 && out[0].length == 4 && out[0].data == CanFrame{}.data);
    }
  }
  return 0;
}
