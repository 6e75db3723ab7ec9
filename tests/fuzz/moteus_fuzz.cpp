// Arbitrary frames, orders and targets to moteus motors: whatever comes, readings are finite or not
// reported, angles in [0, 360), and what is sent is a valid frame within the limits. The simulated drive
// gets the same frames.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "drives/moteus/moteus_family.hpp"
#include "drives/moteus/moteus_motor.hpp"
#include "drives/moteus/moteus_simulated.hpp"
#include "motor_orders.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr double kEffortA = 5.0;
constexpr double kFastestRpm = 300.0;

MotorSettings settings(std::uint8_t kind) {
  MotorSettings result;
  result.name = "arm";
  result.model = "moteus";
  result.id = 1;
  result.direction = (kind & 1U) != 0 ? -1 : 1;
  result.gear_ratio = (kind & 2U) != 0 ? 9.0 : 0.0;
  result.effort_limit = static_cast<float>(kEffortA);
  result.velocity_limit_rpm = static_cast<float>(kFastestRpm);
  result.own.set("motor_kv_rpm_per_v", 304.0);
  result.own.set("rotor_to_output_ratio", (kind & 4U) != 0 ? 0.1 : 1.0);
  result.own.set("absolute", (kind & 8U) != 0 ? 1.0 : 0.0);
  result.own.set("watchdog_ms", 100.0);
  return result;
}

void checkMotor(const Moteus_Motor& motor) {
  const MotorFeedback& feedback = motor.feedback();
  require(std::isfinite(motor.commandValue()));
  for (const float value : {feedback.velocity_rpm, feedback.current_a, feedback.torque_nm, feedback.voltage_v,
                            feedback.temperature_c}) {
    require(!std::isinf(value));
  }
  if (feedback.samples == 0) return;
  require(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
  require(std::isfinite(feedback.total_angle_deg));
}

void checkFrame(const CanFrame& frame, const MotorTraits& traits, double turns, FrameKind ordered) {
  require(frame.fd && isValidLength(true, frame.length) && frame.length <= 48);
  require(frame.id == moteus::queryId(0, 1));
  const double most_nm = kEffortA * static_cast<double>(traits.torque_nm_per_a) * 1.001;
  const bool rests =
      ordered == FrameKind::kRest || ordered == FrameKind::kPoll || ordered == FrameKind::kDisable;
  moteus::Reader reader(frame.payload());
  moteus::Item item;
  moteus::Reader::Step step{};
  while ((step = reader.next(item)) == moteus::Reader::Step::kItem) {
    if (item.kind != moteus::Item::Kind::kWrite) continue;
    switch (item.reg) {
      case moteus::Register::kMode:
        require(item.value == 0.0 || (!rests && (item.value == 10.0 || item.value == 15.0)));
        break;
      case moteus::Register::kCommandPosition: require(!(std::abs(item.value) > 32768.0)); break;
      case moteus::Register::kCommandVelocity:
        require(std::abs(item.value) <= kFastestRpm / 60.0 * turns * 1.001);
        break;
      case moteus::Register::kCommandTorque: require(std::abs(item.value) <= most_nm); break;
      case moteus::Register::kMaxTorque: require(item.value >= 0.0 && item.value <= most_nm); break;
      default: break;
    }
  }
  require(step == moteus::Reader::Step::kEnd);
}

CanFrame takeFrame(Input& input, bool from_drive) {
  CanFrame frame;
  const auto head = input.take<std::uint8_t>();
  frame.id = from_drive ? moteus::replyId(0, 1) : moteus::queryId(0, 1);
  if ((head & 0x40U) != 0) frame.id.value = input.take<std::uint32_t>() & kExtendedIdMask;
  frame.fd = (head & 0x80U) == 0;
  frame.length = frame.fd ? roundUpFdLength(head & 0x3FU) : static_cast<std::uint8_t>(head & 7U);
  for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = input.take<std::uint8_t>();
  return frame;
}

/// A possible answer of a drive, in the right form.
CanFrame takeAnswer(Input& input) {
  moteus::Writer frame(moteus::replyId(0, 1), true);
  const auto head = input.take<std::uint8_t>();
  const auto number = [&input] { return static_cast<double>(input.take<float>()); };
  frame.reply(moteus::Type::kInt8, moteus::Register::kMode, {static_cast<double>(head & 15U)})
      .reply(moteus::Type::kFloat, moteus::Register::kPosition, {number(), number(), number()})
      .reply(moteus::Type::kInt8, moteus::Register::kVoltage,
             {24.0, 30.0, static_cast<double>(input.take<std::uint8_t>() & 127U)})
      .reply(moteus::Type::kInt16, moteus::Register::kMilliseconds,
             {static_cast<double>(input.take<std::int16_t>())});
  if ((head & 16U) != 0) {
    frame.reply(moteus::Type::kInt32, moteus::Register::kRegisterMapVersion, {5.0})
        .reply(moteus::Type::kInt8, moteus::Register::kHomeState, {2.0});
  }
  if ((head & 32U) != 0) frame.reply(moteus::Type::kInt16, moteus::Register::kTimeout, {0.1});
  return frame.frame();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const MotorSettings config = settings(input.take<std::uint8_t>());
  const MotorTraits traits = moteusFamily().traits(config.model, config.own);
  Moteus_Motor motor(config, traits);
  sim::MoteusDrive drive(config, traits, {});
  const double turns = config.gear_ratio > 0.0 ? config.gear_ratio / traits.gear_ratio : 1.0;

  MonotonicTime now{std::chrono::hours{1}};
  Tick tick;
  while (!input.empty()) {
    const auto action = input.take<std::uint8_t>();
    if (action % 10U == 6) {
      drive.receive(takeFrame(input, false));
    } else if (!fuzz::giveOrder(motor, input, action, 10)) {
      CanFrame frame = action % 10U == 7 ? takeFrame(input, true) : takeAnswer(input);
      frame.received = now += Duration{input.take<std::int32_t>()};
      if (motor.matchesFrame(frame)) (void)motor.updateFeedback(frame);
    }
    ++tick.index;
    tick.now = now += std::chrono::milliseconds{1};
    motor.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    require(motor.packCommand(tick, out) == 1);
    checkFrame(out[0], traits, turns, motor.ordered());
    // Between arbitrary frames the real drive answers too.
    drive.receive(out[0]);
    drive.step(std::chrono::milliseconds{1});
    std::array<CanFrame, sim::Drive::kMaxFrames> in{};
    const auto count = drive.answers(in);
    for (std::size_t i = 0; i < count; ++i) {
      require(isValidLength(in[i].fd, in[i].length));
      in[i].received = now;
      if ((action & 0x80U) != 0 && motor.matchesFrame(in[i])) (void)motor.updateFeedback(in[i]);
    }
    require(std::isfinite(drive.physics().outputAngleDeg()) && std::isfinite(drive.physics().currentA()));
    checkMotor(motor);
  }
  return 0;
}
