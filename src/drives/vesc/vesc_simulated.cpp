#include "drives/vesc/vesc_simulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "app/angle.hpp"
#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "drives/vesc/vesc_family.hpp"

// Source of the behaviour: vedderb/bldc@b9d287b:comm/comm_can.c, timeout.c, motor/foc_math.c,
// motor/mcconf_default.h.
namespace rc10::sim {
namespace {

using std::chrono::milliseconds;

constexpr Duration kVescFaultStop = milliseconds{500};  // MCCONF_M_FAULT_STOP_TIME
constexpr Duration kBoot = milliseconds{1000};
constexpr Duration kSlowPeriod = milliseconds{200};  // APPCONF_CAN_STATUS_RATE_2
constexpr double kMinErpm = 900.0;                   // MCCONF_S_PID_MIN_RPM
constexpr double kRampErpmPerS = 25'000.0;           // MCCONF_S_PID_RAMP_ERPMS_S
constexpr double kBrakeFadeRpm = 5.0;                // a brake current fades out with the speed
constexpr std::uint8_t kGetValuesSelective = 50;

std::vector<FrameFilter> vescSends(const MotorSettings& settings) {
  std::vector<FrameFilter> sends;
  for (const auto packet :
       {vesc::Packet::kStatus1, vesc::Packet::kStatus4, vesc::Packet::kStatus5, vesc::Packet::kNotifyBoot}) {
    sends.push_back({.id = vesc::canId(packet, settings.id)});
  }
  // Its answers go to whoever asked: here that is the host.
  sends.push_back(
      {.id = vesc::canId(vesc::Packet::kProcessShortBuffer, vescSettings(settings.own).host_id),
       .discriminators = {PayloadDiscriminator{.value = static_cast<std::uint8_t>(settings.id)}}});
  return sends;
}

std::int16_t raw16(double value, double per_unit) noexcept {
  return static_cast<std::int16_t>(std::clamp(value * per_unit, -32768.0, 32767.0));
}

}  // namespace

VescDrive::VescDrive(const MotorSettings& settings, const MotorLoad& load)
    : ServoDrive(settings, vescTraits(vescSettings(settings.own)), load, vescSends(settings)),
      own_(vescSettings(settings.own)),
      id_(settings.id),
      period_(periodOf(settings.feedback_hz > 0 ? settings.feedback_hz : 50)),
      commanded_(-std::chrono::hours{1}) {  // switched on long before anybody commands it
  steps_zero_ = stepsNow();
}

bool VescDrive::timedOut() const noexcept {
  return watchdog_ > Duration::zero() && elapsed() - commanded_ > watchdog_;
}

void VescDrive::receive(const CanFrame& frame) noexcept {
  if (booting_ || !frame.id.extended || frame.fd || frame.type != FrameType::kData) return;
  const auto to = static_cast<int>(frame.id.value & 0xFFU);
  if (to != id_ && to != vesc::kBroadcast) return;
  if (frame.id.value >> 8U > 0xFFU) return;
  const auto packet = static_cast<vesc::Packet>(frame.id.value >> 8U);
  if (packet == vesc::Packet::kProcessShortBuffer) {
    question(frame);
  } else if (packet == vesc::Packet::kPing && frame.length >= 1) {
    const std::array<std::uint8_t, 2> pong{static_cast<std::uint8_t>(id_), 0};
    answer(makeClassicFrame(vesc::canId(vesc::Packet::kPong, frame.data[0]), pong));
  } else {
    command(packet, frame);
  }
}

void VescDrive::command(vesc::Packet packet, const CanFrame& frame) noexcept {
  // A real drive reads its buffer whatever the length; what is not there is here 0.
  auto number = [&frame](std::size_t at, double scale) {
    return static_cast<double>(readBigEndian<std::int32_t>(std::span{frame.data}, at)) / scale;
  };
  const bool padded = packet == vesc::Packet::kSetCurrent && frame.length >= 6;
  const double amperes = number(padded ? 2 : 0, vesc::kPerAmpere);
  const double share = number(0, vesc::kPerShare);
  const double most = static_cast<double>(own_.motor_current_max_a);
  switch (packet) {
    case vesc::Packet::kSetDuty:
    case vesc::Packet::kSetCurrent:
    case vesc::Packet::kSetCurrentBrake:
    case vesc::Packet::kSetErpm:
    case vesc::Packet::kSetPosition:
    case vesc::Packet::kSetCurrentRelative:
    case vesc::Packet::kSetCurrentBrakeRelative:
    case vesc::Packet::kSetHandbrake:
    case vesc::Packet::kSetHandbrakeRelative: break;
    default: return;
  }
  commanded_ = elapsed();
  if (elapsed() < obeys_from_) return;
  const bool was_regulating = loop_ == Loop::kSpeed;
  loop_ = Loop::kNone;
  const auto hold = [this](double a) {
    const double nm_per_a = physics().parameters().torque_nm_per_a;
    position(driveAngleDeg(), 0.0, std::abs(a) * nm_per_a);
  };
  const auto brake = [this](double a) {
    loop_ = Loop::kBrake;
    brake_a_ = a;
  };
  switch (packet) {
    case vesc::Packet::kSetDuty:
      voltage(std::clamp(share, -1.0, 1.0) * physics().parameters().supply_v);
      break;
    case vesc::Packet::kSetCurrent: current(std::clamp(amperes, -most, most)); break;
    case vesc::Packet::kSetCurrentRelative: current(std::clamp(share, -1.0, 1.0) * most); break;
    case vesc::Packet::kSetCurrentBrake: brake(std::min(std::abs(amperes), most)); break;
    case vesc::Packet::kSetCurrentBrakeRelative: brake(std::min(std::abs(share), 1.0) * most); break;
    case vesc::Packet::kSetHandbrake: hold(std::min(std::abs(amperes), most)); break;
    case vesc::Packet::kSetHandbrakeRelative: hold(std::min(std::abs(share), 1.0) * most); break;
    case vesc::Packet::kSetErpm:
      loop_ = Loop::kSpeed;
      if (!was_regulating) speed_rpm_ = rotorRpm();
      command_rpm_ = number(0, vesc::kPerErpm) / own_.pole_pairs;
      break;
    case vesc::Packet::kSetPosition:
      loop_ = Loop::kPlace;
      place_deg_ = number(0, vesc::kPerDegree);
      break;
    default: break;
  }
}

void VescDrive::question(const CanFrame& frame) noexcept {
  if (frame.length != 7 || frame.data[1] != 0 || frame.data[2] != kGetValuesSelective) return;
  const auto mask = readBigEndian<std::uint32_t>(frame.payload(), 3);
  if (mask != vesc::kAskFault && mask != vesc::kAskStatus) return;
  std::array<std::uint8_t, 8> reply{static_cast<std::uint8_t>(id_), 1, kGetValuesSelective};
  writeBigEndian<std::uint32_t>(reply, 3, mask);
  reply[7] = mask == vesc::kAskFault ? fault_ : (timedOut() ? vesc::kTimedOut : std::uint8_t{0});
  answer(makeClassicFrame(vesc::canId(vesc::Packet::kProcessShortBuffer, frame.data[0]), reply));
}

void VescDrive::stepLoop(Duration dt) noexcept {
  switch (loop_) {
    case Loop::kNone: return;
    case Loop::kBrake: return current(-brake_a_ * std::clamp(rotorRpm() / kBrakeFadeRpm, -1.0, 1.0));
    case Loop::kSpeed: return stepSpeed(dt);
    case Loop::kPlace:  // the shortest way from where it is now, as foc_run_pid_control_pos() goes
      return position(driveAngleDeg() + shortestAngle(encoderDeg(), place_deg_) * own_.position_divider);
  }
}

void VescDrive::stepSpeed(Duration dt) noexcept {
  const double ramp = kRampErpmPerS / own_.pole_pairs * std::chrono::duration<double>(dt).count();
  speed_rpm_ += std::clamp(command_rpm_ - speed_rpm_, -ramp, ramp);
  if (std::abs(speed_rpm_) * own_.pole_pairs < kMinErpm) {
    release();
  } else {
    velocity(speed_rpm_);
  }
}

void VescDrive::step(Duration dt) noexcept {
  for (Duration left = dt; left > Duration::zero();) {
    const Duration part = std::min(left, MotorPhysics::kLongestStep);
    if (booting_ || timedOut() || elapsed() < obeys_from_) {
      loop_ = Loop::kNone;
      release();  // with the stock brake current of 0 A
    }
    stepLoop(part);
    ServoDrive::step(part);
    left -= part;
  }
  if (elapsed() >= obeys_from_) fault_ = 0;
  if (booting_ && elapsed() >= speaks_from_) {
    booting_ = false;
    constexpr std::array<std::uint8_t, 2> kHardware{'6', '0'};
    answer(makeClassicFrame(vesc::canId(vesc::Packet::kNotifyBoot, id_), kHardware));
  }
}

double VescDrive::dutyNow() const noexcept {
  const auto& p = physics().parameters();
  const double volts = p.back_emf_vs_per_rad * rotorRpm() * kRadPerSPerRpm + p.resistance_ohm * currentA();
  return std::clamp(volts / p.supply_v, -1.0, 1.0);
}

/// Input of its position loop: the rotor's angle, or that angle after the divider.
double VescDrive::encoderDeg() const noexcept {
  return wrapDegrees(driveAngleDeg() / own_.position_divider - divided_zero_deg_);
}

std::int64_t VescDrive::stepsNow() const noexcept {
  return static_cast<std::int64_t>(std::floor(driveAngleDeg() * own_.pole_pairs / 60.0));
}

CanFrame VescDrive::status(vesc::Packet packet) const noexcept {
  std::array<std::uint8_t, 8> payload{};
  if (packet == vesc::Packet::kStatus1) {
    const double duty = dutyNow();
    // The sign of the power.
    const double current_a = duty * currentA() < 0.0 ? -std::abs(currentA()) : std::abs(currentA());
    writeBigEndian<std::int32_t>(payload, 0, static_cast<std::int32_t>(rotorRpm() * own_.pole_pairs));
    writeBigEndian<std::int16_t>(payload, 4, raw16(current_a, 10.0));
    writeBigEndian<std::int16_t>(payload, 6, raw16(duty, 1000.0));
  } else if (packet == vesc::Packet::kStatus4) {
    writeBigEndian<std::int16_t>(payload, 0, raw16(physics().parameters().ambient_c + 5.0, 10.0));
    writeBigEndian<std::int16_t>(payload, 2, raw16(physics().temperatureC(), 10.0));
    writeBigEndian<std::int16_t>(payload, 4, raw16(dutyNow() * currentA(), 10.0));
    writeBigEndian<std::int16_t>(payload, 6, raw16(encoderDeg(), 50.0));
  } else {
    writeBigEndian<std::int32_t>(
        payload, 0, static_cast<std::int32_t>(static_cast<std::uint32_t>(stepsNow() - steps_zero_)));
    writeBigEndian<std::int16_t>(payload, 4, raw16(physics().parameters().supply_v, 10.0));
  }
  return makeClassicFrame(vesc::canId(packet, id_), payload);
}

std::size_t VescDrive::feedback(std::span<CanFrame> out) noexcept {
  if (booting_) return 0;
  const bool slow = elapsed() >= slow_next_;
  if (slow) slow_next_ = elapsed() + kSlowPeriod;
  std::size_t count = 0;
  const auto send = [&](vesc::Packet packet) {
    if (count < out.size()) out[count++] = status(packet);
  };
  send(vesc::Packet::kStatus1);
  if (slow || own_.angle == VescAngle::kEncoder) send(vesc::Packet::kStatus4);
  if (slow || own_.angle == VescAngle::kTachometer) send(vesc::Packet::kStatus5);
  return count;
}

void VescDrive::restart() noexcept {
  release();
  booting_ = true;
  loop_ = Loop::kNone;
  fault_ = 0;
  obeys_from_ = {};
  speaks_from_ = elapsed() + kBoot;
  commanded_ = elapsed();
  steps_zero_ = stepsNow();
  // With a divider it cannot know the turn it is in.
  if (own_.position_divider != 1.0) {
    divided_zero_deg_ = (driveAngleDeg() - wrapDegrees(driveAngleDeg())) / own_.position_divider;
  }
}

void VescDrive::fault(std::uint32_t native_code) noexcept {
  fault_ = static_cast<std::uint8_t>(std::min<std::uint32_t>(native_code, 255));
  obeys_from_ = native_code == 0 ? Duration::zero() : elapsed() + kVescFaultStop;
}

std::unique_ptr<Drive> makeVescDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<VescDrive>(settings, load);
}

}  // namespace rc10::sim
