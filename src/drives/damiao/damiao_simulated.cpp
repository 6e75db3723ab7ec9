#include "drives/damiao/damiao_simulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "app/angle.hpp"
#include "app/limits.hpp"
#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "drives/damiao/damiao_family.hpp"
#include "sim/wrapped_code.hpp"

namespace rc10::sim {

using damiao::Register;

namespace {

constexpr std::uint8_t kDriveC = 30;
constexpr auto kTimeoutStep = std::chrono::microseconds{50};

double readFinite(std::span<const std::uint8_t> payload, std::size_t at) noexcept {
  return static_cast<double>(finiteOr0(readLittleEndian<float>(payload, at)));
}

/// Registers that are only kept.
std::optional<std::size_t> otherIndex(Register address) noexcept {
  constexpr std::array kKept{Register::kUnderVoltage, Register::kOverTemperature, Register::kOverCurrent,
                             Register::kAcceleration, Register::kDeceleration,    Register::kMaxSpeed,
                             Register::kOverVoltage};
  const auto* const found = std::find(kKept.begin(), kKept.end(), address);
  if (found == kKept.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kKept.begin());
}

/// Data of the motor and its make: read only. A datum that the model lacks is 0.
std::optional<std::uint32_t> nameplate(Register address, const MotorTraits& traits) noexcept {
  constexpr std::uint32_t kVersion = 1;
  switch (address) {
    case Register::kTorqueConstant: return damiao::bitsOf(traits.torque_nm_per_a);
    case Register::kInertia: return damiao::bitsOf(traits.rotor_inertia_kg_m2);
    case Register::kHardwareVersion:
    case Register::kSoftwareVersion:
    case Register::kSerialNumber: return kVersion;
    case Register::kResistance: return damiao::bitsOf(traits.phase_resistance_ohm);
    case Register::kGear: return damiao::bitsOf(static_cast<float>(traits.gear_ratio));
    case Register::kDamping:
    case Register::kPolePairs:
    case Register::kInductance:
    case Register::kFlux: return 0;
    default: return std::nullopt;
  }
}

std::vector<FrameFilter> sent(const MotorSettings& settings) { return damiaoFamily().busUse(settings).sends; }

}  // namespace

DamiaoDrive::DamiaoDrive(const MotorSettings& settings, const MotorLoad& load)
    : ServoDrive(settings, damiaoFamily().traits(settings.model, settings.own), load, sent(settings)),
      id_(settings.id),
      own_(damiaoSettings(settings)) {
  saved_.scale = own_.scale;
  saved_.id = id_;
  saved_.master_id = own_.master_id;
  registers_ = saved_;
  rebase();
}

double DamiaoDrive::positionRad() const noexcept { return driveAngleDeg() / kDegPerRad; }

// At power-up it knows no turns.
void DamiaoDrive::rebase() noexcept { zeroAt(shortestAngle(0.0, driveAngleDeg())); }

void DamiaoDrive::restart() noexcept {
  registers_ = saved_;
  id_ = saved_.id;
  own_.master_id = saved_.master_id;
  fault_ = 0;
  disarm();
  rebase();
}

void DamiaoDrive::disarm() noexcept {
  armed_ = false;
  setpoint_ = {};
  setpoint_.control = static_cast<DamiaoControl>(registers_.control);
  release();
}

void DamiaoDrive::fault(std::uint32_t native_code) noexcept {
  fault_ = static_cast<std::uint8_t>(native_code & 0xFU);
  if (fault_ != 0) disarm();
}

void DamiaoDrive::receive(const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.id.extended || (frame.fd && !own_.can_fd) || stores()) return;
  const auto payload = std::span(frame.data).first<8>();
  if (frame.id.value == damiao::kRegisterId && frame.length >= 4 && payload[0] == id_ && payload[1] == 0) {
    receiveRegister(payload);
    return;
  }
  if ((frame.id.value & damiao::kAddressMask) != static_cast<std::uint32_t>(id_)) return;
  heard_ = elapsed();
  if (!receiveSpecial(payload)) receiveSetpoint(frame.id.value >> 8U, frame);
  sendState();
}

bool DamiaoDrive::receiveSpecial(std::span<const std::uint8_t, 8> payload) noexcept {
  if (std::any_of(payload.begin(), payload.end() - 1, [](auto byte) { return byte != 0xFF; })) return false;
  switch (static_cast<damiao::Special>(payload[7])) {
    case damiao::Special::kEnable:
      if (fault_ == 0) armed_ = true;
      follow();
      return true;
    case damiao::Special::kDisable: disarm(); return true;
    case damiao::Special::kClear:
      fault_ = 0;
      disarm();
      return true;
    case damiao::Special::kZero: zeroAt(0.0); return true;
  }
  return false;
}

void DamiaoDrive::receiveSetpoint(std::uint32_t family, const CanFrame& frame) noexcept {
  if (family + 1 != registers_.control) return;
  const auto payload = std::span(frame.data).first<8>();
  setpoint_.control = static_cast<DamiaoControl>(registers_.control);
  switch (setpoint_.control) {
    case DamiaoControl::kMit: setpoint_.mit = damiao::readMit(payload, registers_.scale); break;
    case DamiaoControl::kPositionVelocity:
      setpoint_.position_rad = readFinite(payload, 0);
      setpoint_.velocity_rad_s = std::fabs(readFinite(payload, 4));
      break;
    case DamiaoControl::kVelocity: setpoint_.velocity_rad_s = readFinite(payload, 0); break;
    case DamiaoControl::kForcePosition: {
      constexpr std::uint16_t kMost = 10'000;
      setpoint_.position_rad = readFinite(payload, 0);
      setpoint_.velocity_rad_s = std::min(readLittleEndian<std::uint16_t>(payload, 4), kMost) * 0.01;
      setpoint_.current_pu = std::min(readLittleEndian<std::uint16_t>(payload, 6), kMost) * 0.0001;
      break;
    }
  }
  follow();
}

void DamiaoDrive::follow() noexcept {
  if (!armed_) return;
  const auto& s = setpoint_;
  const double position_deg = s.position_rad * kDegPerRad;
  const double rpm = s.velocity_rad_s * kRpmPerRadPerS;
  switch (s.control) {
    case DamiaoControl::kMit:
      impedance(s.mit.position_rad * kDegPerRad, s.mit.velocity_rad_s * kRpmPerRadPerS,
                s.mit.stiffness_nm_per_rad, s.mit.damping_nms_per_rad, s.mit.torque_nm);
      break;
    case DamiaoControl::kVelocity: velocity(rpm); break;
    // A limit of 0 is a standstill; to the loops below it would be none.
    case DamiaoControl::kPositionVelocity: rpm > 0.0 ? position(position_deg, rpm) : velocity(0.0); break;
    case DamiaoControl::kForcePosition: {
      const double nm =
          s.current_pu * static_cast<double>(traits().effort_full_scale * traits().torque_nm_per_a);
      if (nm <= 0.0) {
        torque(0.0);
      } else if (rpm > 0.0) {
        position(position_deg, rpm, nm);
      } else {
        velocity(0.0, 0.0, nm);
      }
      break;
    }
  }
}

void DamiaoDrive::step(Duration dt) noexcept {
  ServoDrive::step(dt);
  // Counts only while enabled; frames to the registers do not count as commands.
  if (armed_ && registers_.timeout != 0 && elapsed() - heard_ > registers_.timeout * kTimeoutStep) {
    fault(0xD);
  }
}

void DamiaoDrive::sendState() noexcept {
  const auto& scale = registers_.scale;
  const auto status = fault_ != 0 ? fault_ : (armed_ ? damiao::kStatusEnabled : damiao::kStatusDisabled);
  send(damiao::writeState(id_, {.status = status,
                                .position = wrappedCode(positionRad(), scale.p_max_rad, 16),
                                .velocity = wrappedCode(driveRpm() / kRpmPerRadPerS, scale.v_max_rad_s, 12),
                                .torque = wrappedCode(driveTorqueNm(), scale.t_max_nm, 12),
                                .drive_temperature = kDriveC,
                                .winding_temperature = static_cast<std::uint8_t>(
                                    std::clamp(physics().temperatureC(), 0.0, 255.0))}));
}

void DamiaoDrive::send(const damiao::Payload& payload) noexcept {
  const CanId id{own_.master_id, false};
  answer(own_.can_fd ? makeFdFrame(id, payload, true) : makeClassicFrame(id, payload));
}

void DamiaoDrive::receiveRegister(std::span<const std::uint8_t, 8> payload) noexcept {
  const std::uint8_t address = payload[3];
  if (payload[2] == damiao::kWriteOperation) {
    const auto value = readLittleEndian<std::uint32_t>(payload, 4);
    if (write(address, value)) send(damiao::writeRegister(id_, static_cast<Register>(address), value));
    return;
  }
  if (payload[2] == damiao::kSaveOperation) {
    if (armed_) return;
    saved_ = registers_;
    store();
    return send(damiao::saveRegisters(id_));
  }
  if (payload[2] == damiao::kStateOperation) return sendState();
  if (payload[2] != damiao::kReadOperation) return;
  std::uint32_t value = 0;
  const auto& scale = registers_.scale;
  switch (static_cast<Register>(address)) {
    case Register::kTimeout: value = registers_.timeout; break;
    case Register::kControlMode: value = registers_.control; break;
    case Register::kPMax: value = damiao::bitsOf(static_cast<float>(scale.p_max_rad)); break;
    case Register::kVMax: value = damiao::bitsOf(static_cast<float>(scale.v_max_rad_s)); break;
    case Register::kTMax: value = damiao::bitsOf(static_cast<float>(scale.t_max_nm)); break;
    case Register::kOutputPosition: value = damiao::bitsOf(static_cast<float>(positionRad())); break;
    case Register::kMasterId: value = registers_.master_id; break;
    case Register::kId: value = static_cast<std::uint32_t>(registers_.id); break;
    default: {
      const auto other = otherIndex(static_cast<Register>(address));
      const auto plate = nameplate(static_cast<Register>(address), traits());
      if (!other && !plate) return;
      value = other ? registers_.others[*other] : *plate;
    }
  }
  auto reply = damiao::readRegister(id_, static_cast<Register>(address));
  writeLittleEndian(std::span<std::uint8_t>(reply), 4, value);
  send(reply);
}

bool DamiaoDrive::write(std::uint8_t address, std::uint32_t value) noexcept {
  const auto set_scale = [value](double& field) {
    const float number = damiao::floatOf(value);
    if (!(number > 0.0F) || !std::isfinite(number)) return false;
    field = static_cast<double>(number);
    return true;
  };
  switch (static_cast<Register>(address)) {
    case Register::kTimeout: registers_.timeout = value; return true;
    case Register::kControlMode:
      if (value < 1 || value > 4) return false;
      if (registers_.control != value) {
        registers_.control = value;
        setpoint_ = {};
        setpoint_.control = static_cast<DamiaoControl>(value);
        follow();
      }
      return true;
    case Register::kPMax: return set_scale(registers_.scale.p_max_rad);
    case Register::kVMax: return set_scale(registers_.scale.v_max_rad_s);
    case Register::kTMax: return set_scale(registers_.scale.t_max_nm);
    case Register::kMasterId: registers_.master_id = value; return true;
    case Register::kId: registers_.id = static_cast<int>(value & 0xFFU); return true;
    default: {
      const auto other = otherIndex(static_cast<Register>(address));
      if (other) registers_.others[*other] = value;
      return other.has_value();
    }
  }
}

std::unique_ptr<Drive> makeDamiaoDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<DamiaoDrive>(settings, load);
}

}  // namespace rc10::sim
