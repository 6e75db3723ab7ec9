#include "drives/odrive/odrive_simulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/limits.hpp"
#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "drives/odrive/odrive_family.hpp"

namespace rc10::sim {
namespace {

using std::chrono::milliseconds;

constexpr Duration kHeartbeatPeriod = milliseconds{100};
// Nothing is sent before the firmware runs, and nothing useful before its current sensors have settled.
constexpr Duration kBootSilence = milliseconds{300};
constexpr Duration kOdriveBootTime = milliseconds{1500};

constexpr std::uint32_t kInitializing = 0x1;
constexpr std::uint32_t kInvalidState = 0x1;
constexpr double kFeedForwardUnit = 0.001;
// controller.config.vel_gain as delivered, N·m per turn/s. Source: ODrive 0.5.6, controller.hpp, Config_t.
constexpr double kTorquePerTurnPerS = 1.0 / 6.0;
// KV * torque constant, in rpm/V * N·m/A: the vendor's own number.
constexpr float kKvTimesTorqueConstant = 8.27F;

Duration periodOf(double hz) noexcept {
  if (!(hz > 0.0)) return Duration::zero();
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / hz));
}

/// The simulation needs a speed; what the family's guards are told stays unknown.
MotorTraits withSpeed(MotorTraits traits) noexcept {
  if (!(traits.no_load_rpm > 0.0F) && traits.torque_nm_per_a > 0.0F) {
    traits.no_load_rpm = kKvTimesTorqueConstant / traits.torque_nm_per_a * traits.nominal_v;
  }
  return traits;
}

CanFrame pair(int node, odrive::Message message, double first, double second) noexcept {
  std::array<std::uint8_t, 8> payload{};
  writeLittleEndian(std::span<std::uint8_t>{payload}, 0, static_cast<float>(first));
  writeLittleEndian(std::span<std::uint8_t>{payload}, 4, static_cast<float>(second));
  return makeClassicFrame(odrive::canId(node, message), payload);
}

}  // namespace

OdriveDrive::OdriveDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load)
    : ServoDrive(
          settings, withSpeed(traits), load,
          {FrameFilter{.id = odrive::canId(settings.id, odrive::Message{}), .mask = odrive::kNodeMask}}),
      node_(settings.id),
      firmware_(findOdriveModel(settings.model) != nullptr ? findOdriveModel(settings.model)->firmware
                                                           : OdriveFirmware::k06),
      feedback_period_(periodOf(settings.feedback_hz > 0 ? settings.feedback_hz : traits.feedback_hz)),
      telemetry_period_(periodOf(settings.own.number("telemetry_hz"))),
      torque_constant_nm_per_a_(static_cast<double>(traits.torque_nm_per_a)) {
  zeroAt(0.0);  // an incremental encoder
}

double OdriveDrive::torqueLimitNm() const noexcept { return current_limit_a_ * torque_constant_nm_per_a_; }

void OdriveDrive::disarm(std::uint32_t errors) noexcept {
  errors_ |= errors;
  state_ = odrive::AxisState::kIdle;
  release();
}

void OdriveDrive::requestState(std::uint32_t state) noexcept {
  if (firmware_ == OdriveFirmware::k05) errors_ &= ~kInvalidState;
  if (state != static_cast<std::uint32_t>(odrive::AxisState::kClosedLoop)) return disarm(0);
  if (errors_ != 0) return disarm(0);
  // Begins where it is.
  input_turns_ = driveAngleDeg() / kDegPerTurn;
  state_ = odrive::AxisState::kClosedLoop;
  drive();
}

void OdriveDrive::drive() noexcept {
  if (state_ != odrive::AxisState::kClosedLoop) return;
  const double limit_nm = torqueLimitNm();
  const double limit_rpm = velocity_limit_turns_per_s_ * kRpmPerTurnPerS;
  const double torque_nm = std::clamp(input_torque_nm_, -limit_nm, limit_nm);
  switch (control_mode_) {
    case odrive::ControlMode::kTorque: {
      // enable_torque_mode_vel_limit, on as delivered; the limit of the torque comes last. Source: ODrive
      // 0.5.6, controller.cpp, limitVel() and Controller::update(). 0.6 is not published; taken as the same.
      const double turns_per_s = driveRpm() / kRpmPerTurnPerS;
      const double slowed_nm =
          std::clamp(torque_nm, kTorquePerTurnPerS * (-velocity_limit_turns_per_s_ - turns_per_s),
                     kTorquePerTurnPerS * (velocity_limit_turns_per_s_ - turns_per_s));
      return torque(std::clamp(slowed_nm, -limit_nm, limit_nm));
    }
    case odrive::ControlMode::kVelocity:
      return velocity(std::clamp(input_turns_per_s_ * kRpmPerTurnPerS, -limit_rpm, limit_rpm), torque_nm,
                      limit_nm);
    case odrive::ControlMode::kPosition: return position(input_turns_ * kDegPerTurn, limit_rpm, limit_nm);
  }
  disarm(kInvalidState);
}

void OdriveDrive::receive(const CanFrame& frame) noexcept {
  if (frame.id.extended || frame.fd || frame.type == FrameType::kError) return;
  if ((frame.id.value & odrive::kNodeMask) != odrive::canId(node_, odrive::Message{}).value || starting())
    return;
  // 0.5: whatever is addressed to the node (CANSimple::do_command). 0.6 is not published; taken as the same.
  fed_at_ = elapsed();
  if (frame.type == FrameType::kRemote) return answerQuestion(odrive::messageOf(frame.id));
  std::array<std::uint8_t, 8> data{};
  std::copy_n(frame.data.begin(), std::min<std::size_t>(frame.length, data.size()), data.begin());
  const std::span<const std::uint8_t> bytes{data};
  const auto number = [&](std::size_t at) {
    return finiteOr0(static_cast<double>(readLittleEndian<float>(bytes, at)));
  };
  const auto feed_forward = [&](std::size_t at) {
    return kFeedForwardUnit * readLittleEndian<std::int16_t>(bytes, at);
  };
  switch (odrive::messageOf(frame.id)) {
    case odrive::Message::kEstop: disarm(firmware_ == OdriveFirmware::k05 ? 0x4000U : 0x0200'0000U); break;
    case odrive::Message::kSetAxisState: requestState(readLittleEndian<std::uint32_t>(bytes, 0)); break;
    case odrive::Message::kSetControllerMode:
      control_mode_ = static_cast<odrive::ControlMode>(readLittleEndian<std::int32_t>(bytes, 0));
      if (control_mode_ == odrive::ControlMode::kPosition) input_turns_ = driveAngleDeg() / kDegPerTurn;
      break;
    case odrive::Message::kSetInputPos:
      input_turns_ = number(0);
      input_turns_per_s_ = feed_forward(4);
      input_torque_nm_ = feed_forward(6);
      break;
    case odrive::Message::kSetInputVel:
      input_turns_per_s_ = number(0);
      input_torque_nm_ = number(4);
      break;
    case odrive::Message::kSetInputTorque: input_torque_nm_ = number(0); break;
    case odrive::Message::kSetLimits:
      velocity_limit_turns_per_s_ = std::max(number(0), 0.0);
      current_limit_a_ = std::max(number(4), 0.0);
      break;
    case odrive::Message::kReboot: restart(); break;
    case odrive::Message::kClearErrors: errors_ = 0; break;
    default: break;
  }
  drive();
}

// A remote frame asks. Values that are not known of this firmware get no answer.
void OdriveDrive::answerQuestion(odrive::Message asked) noexcept {
  switch (asked) {
    case odrive::Message::kHeartbeat: return answer(heartbeat());
    case odrive::Message::kEncoderEstimates: return answer(estimates());
    case odrive::Message::kIq: return answer(pair(node_, asked, currentA(), currentA()));
    case odrive::Message::kBusVoltage: return answer(busVoltage());
    case odrive::Message::kTemperature:
      if (firmware_ == OdriveFirmware::k06) answer(temperatures());
      return;
    case odrive::Message::kTorques:
      if (firmware_ == OdriveFirmware::k06) answer(torques());
      return;
    default: return;
  }
}

CanFrame OdriveDrive::estimates() const noexcept {
  return pair(node_, odrive::Message::kEncoderEstimates, driveAngleDeg() / kDegPerTurn,
              driveRpm() / kRpmPerTurnPerS);
}

CanFrame OdriveDrive::busVoltage() const noexcept {
  return pair(node_, odrive::Message::kBusVoltage, static_cast<double>(traits().nominal_v), 0.0);
}

CanFrame OdriveDrive::temperatures() const noexcept {
  return pair(node_, odrive::Message::kTemperature, physics().temperatureC(), physics().temperatureC());
}

CanFrame OdriveDrive::torques() const noexcept {
  return pair(node_, odrive::Message::kTorques, driveTorqueNm(), driveTorqueNm());
}

void OdriveDrive::step(Duration dt) noexcept {
  ServoDrive::step(dt);
  // It counts in every state, so an idle axis that nobody talks to expires too.
  if (watchdog_ > Duration::zero() && !starting() && elapsed() - fed_at_ > watchdog_) {
    disarm(firmware_ == OdriveFirmware::k05 ? 0x800U : 0x0100'0000U);
  }
}

CanFrame OdriveDrive::heartbeat() const noexcept {
  const bool v05 = firmware_ == OdriveFirmware::k05;
  std::array<std::uint8_t, 8> payload{};
  const std::uint32_t errors = errors_ | (starting() && !v05 ? kInitializing : 0U);
  writeLittleEndian(std::span<std::uint8_t>{payload}, 0, errors);
  payload[4] = static_cast<std::uint8_t>(starting() ? odrive::AxisState::kUndefined : state_);
  if (v05) {
    payload[5] = (errors & 0x40U) != 0 ? 1 : 0;
    payload[6] = (errors & 0x100U) != 0 ? 1 : 0;
    payload[7] = (errors & 0x200U) != 0 ? 1 : 0;
  }
  return makeClassicFrame(odrive::canId(node_, odrive::Message::kHeartbeat), payload);
}

std::size_t OdriveDrive::feedback(std::span<CanFrame> out) noexcept {
  if (elapsed() < silent_until_) return 0;
  std::size_t count = 0;
  const auto add = [&](const CanFrame& frame) {
    if (count < out.size()) out[count++] = frame;
  };
  if (elapsed() >= next_heartbeat_) {
    next_heartbeat_ = elapsed() + kHeartbeatPeriod;
    add(heartbeat());
  }
  add(estimates());
  if (telemetry_period_ > Duration::zero() && elapsed() >= next_telemetry_) {
    next_telemetry_ = elapsed() + telemetry_period_;
    add(busVoltage());
    if (firmware_ == OdriveFirmware::k05) {
      add(pair(node_, odrive::Message::kIq, currentA(), currentA()));
    } else {
      add(torques());
      add(temperatures());
    }
  }
  return count;
}

void OdriveDrive::restart() noexcept {
  disarm(0);
  errors_ = 0;
  control_mode_ = odrive::ControlMode::kPosition;
  input_turns_ = 0.0;
  input_turns_per_s_ = 0.0;
  input_torque_nm_ = 0.0;
  velocity_limit_turns_per_s_ = 2.0;
  current_limit_a_ = 10.0;
  zeroAt(0.0);
  silent_until_ = elapsed() + kBootSilence;
  ready_at_ = elapsed() + kOdriveBootTime;
  fed_at_ = ready_at_;
  next_heartbeat_ = silent_until_;
  next_telemetry_ = silent_until_;
}

void OdriveDrive::fault(std::uint32_t native_code) noexcept {
  if (native_code == 0) {
    errors_ = 0;
  } else {
    disarm(native_code);
  }
}

void OdriveDrive::setWatchdog(Duration timeout) noexcept {
  watchdog_ = timeout;
  fed_at_ = elapsed();
}

std::unique_ptr<Drive> makeOdriveDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<OdriveDrive>(settings, odriveFamily().traits(settings.model, settings.own), load);
}

}  // namespace rc10::sim
