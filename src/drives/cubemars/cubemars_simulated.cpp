#include "drives/cubemars/cubemars_simulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "drives/cubemars/cubemars_family.hpp"
#include "sim/wrapped_code.hpp"

namespace rc10::sim {
namespace {

// timeout_msec and m_fault_stop_time_ms of the settings exported from an AK70-10 (cubemars_hardware,
// .params); what they do is in the VESC firmware, from which those settings are. In MIT mode of V1 and V2 no
// timeout is known: the last command holds.
constexpr Duration kCommandTimeout = std::chrono::milliseconds{1000};
constexpr Duration kCubemarsFaultStop = std::chrono::milliseconds{500};
constexpr Duration kStartUp = std::chrono::milliseconds{300};  // assumed

std::vector<FrameFilter> cubemarsSends(const MotorSettings& settings, const CubemarsSettings& own) {
  if (own.protocol != CubemarsProtocol::kMit) return {{.id = cubemars::servoFeedbackId(settings.id)}};
  const PayloadDiscriminator sender{.value = static_cast<std::uint8_t>(settings.id)};
  return {{.id = {0, false}, .mask = kStandardIdMask, .discriminators = {sender}}};
}

double scaled(std::uint32_t code, double low, double high, double last_code) noexcept {
  return low + (high - low) * code / last_code;
}

std::int16_t int16Of(double value, double limit) noexcept {
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -limit, limit)));
}

}  // namespace

CubemarsDrive::CubemarsDrive(const MotorSettings& settings, const CubemarsSettings& own,
                             const MotorLoad& load)
    : ServoDrive(settings, cubemarsTraits(own), load, cubemarsSends(settings, own)),
      own_(own),
      id_(settings.id) {
  feedback_period_ = periodOf(settings.feedback_hz > 0 ? settings.feedback_hz : traits().feedback_hz);
}

Duration CubemarsDrive::feedbackPeriod() const noexcept {
  return own_.protocol == CubemarsProtocol::kMit ? Duration::zero() : feedback_period_;
}

std::size_t CubemarsDrive::feedback(std::span<CanFrame> out) noexcept {
  if (own_.protocol == CubemarsProtocol::kMit || off() || out.empty()) return 0;
  out[0] = servoFeedback();
  return 1;
}

double CubemarsDrive::rpmOf(double erpm) const noexcept {
  return erpm / (own_.model->gear_ratio * own_.pole_pairs);
}

void CubemarsDrive::receive(const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.fd || off()) return;
  if (own_.protocol == CubemarsProtocol::kMit) {
    if (frame.id == CanId{static_cast<std::uint32_t>(id_), false} && frame.length == 8) receiveMit(frame);
  } else if (frame.id.extended && (frame.id.value & 0xFFU) == static_cast<std::uint32_t>(id_)) {
    receiveServo(frame);
  }
}

void CubemarsDrive::receiveServo(const CanFrame& frame) noexcept {
  constexpr std::array<std::size_t, 9> kLengths{4, 4, 4, 4, 4, 1, 8, 9, 8};  // 7 is no command
  const std::uint32_t command = frame.id.value >> 8U;
  if (command >= kLengths.size() || frame.length < kLengths[command]) return;
  if (command == 8 && own_.protocol != CubemarsProtocol::kMitV3) return;
  last_command_ = elapsed();
  if (error_ != 0) return;
  const auto bytes = frame.payload();
  const double value = frame.length >= 4 ? readBigEndian<std::int32_t>(bytes, 0) : 0;
  switch (command) {
    case 0: voltage(std::clamp(value / 1e5, -1.0, 1.0) * static_cast<double>(traits().nominal_v)); break;
    case 1: current(std::clamp(value / 1e3, -60.0, 60.0)); break;
    case 2: {
      const double nm = value / 1e3 * static_cast<double>(own_.torque_nm_per_a);
      if (nm > 0.0) {
        velocity(0.0, 0.0, nm);
      } else {
        release();
      }
      break;
    }
    case 3: velocity(rpmOf(value)); break;
    case 4: setDrivePosition(value / 1e4, 0.0); break;
    case 5: zeroAt(0.0); break;
    case 6: setDrivePosition(value / 1e4, rpmOf(10.0 * readBigEndian<std::int16_t>(bytes, 4))); break;
    case 8:
      takeLaw(readBigEndian<std::uint16_t>(bytes, 3),
              static_cast<std::uint32_t>(bytes[5] << 4 | bytes[6] >> 4),
              static_cast<std::uint32_t>(bytes[0] << 4 | bytes[1] >> 4),
              static_cast<std::uint32_t>((bytes[1] & 0xF) << 8 | bytes[2]),
              static_cast<std::uint32_t>((bytes[6] & 0xF) << 8 | bytes[7]));
      break;
    default: break;
  }
}

void CubemarsDrive::setDrivePosition(double message_deg, double limit_rpm) noexcept {
  position(message_deg / own_.message_deg_per_deg, limit_rpm);
}

void CubemarsDrive::receiveMit(const CanFrame& frame) noexcept {
  const auto bytes = frame.payload();
  const bool special = std::all_of(bytes.begin(), bytes.begin() + 7, [](auto byte) { return byte == 0xFF; });
  if (special && bytes[7] == 0xFC) {
    entered_ = true;
    error_ = 0;
    followLaw();
  } else if (special && bytes[7] == 0xFD) {
    entered_ = false;
    release();
  } else if (special && bytes[7] == 0xFE) {
    zeroAt(0.0);
  } else if (entered_ && error_ == 0) {
    takeLaw(readBigEndian<std::uint16_t>(bytes, 0), static_cast<std::uint32_t>(bytes[2] << 4 | bytes[3] >> 4),
            static_cast<std::uint32_t>((bytes[3] & 0xF) << 8 | bytes[4]),
            static_cast<std::uint32_t>(bytes[5] << 4 | bytes[6] >> 4),
            static_cast<std::uint32_t>((bytes[6] & 0xF) << 8 | bytes[7]));
  }
  answer(mitReply());
}

void CubemarsDrive::takeLaw(std::uint32_t position, std::uint32_t velocity, std::uint32_t stiffness,
                            std::uint32_t damping, std::uint32_t torque) noexcept {
  const auto& r = own_.ranges;
  const auto both = [](std::uint32_t code, double reach, double last) {
    return scaled(code, -reach, reach, last);
  };
  law_ = {.position_rad = both(position, r.position_rad, 65535.0),
          .velocity_rad_s = both(velocity, r.velocity_rad_s, 4095.0),
          .stiffness_nm_per_rad = scaled(stiffness, 0.0, 500.0, 4095.0),
          .damping_nms_per_rad = scaled(damping, 0.0, 5.0, 4095.0),
          .torque_nm = both(torque, r.torque_nm, 4095.0)};
  followLaw();
}

void CubemarsDrive::followLaw() noexcept {
  impedance(law_.position_rad / kRadPerDeg, law_.velocity_rad_s / kRadPerSPerRpm, law_.stiffness_nm_per_rad,
            law_.damping_nms_per_rad, law_.torque_nm);
}

void CubemarsDrive::step(Duration dt) noexcept {
  ServoDrive::step(dt);
  if (own_.protocol == CubemarsProtocol::kMit) return;
  if (elapsed() - last_command_ > kCommandTimeout) release();
  if (error_ != 0 && elapsed() >= error_until_) error_ = 0;
}

void CubemarsDrive::restart() noexcept {
  release();
  law_ = {};
  entered_ = false;
  error_ = 0;
  boots_until_ = elapsed() + kStartUp;
  if (own_.output_encoder) return;
  const double rotor_turn_deg = kDegPerTurn / own_.model->gear_ratio;
  zeroAt(std::remainder(driveAngleDeg(), rotor_turn_deg));
}

void CubemarsDrive::fault(std::uint32_t native_code) noexcept {
  error_ = static_cast<std::uint8_t>(std::min(native_code, 255U));
  error_until_ = elapsed() + kCubemarsFaultStop;
  if (error_ != 0) release();
}

CanFrame CubemarsDrive::servoFeedback() const noexcept {
  std::array<std::uint8_t, 8> data{};
  const double amperes = own_.model->signed_current ? currentA() : std::fabs(currentA());
  const double erpm = driveRpm() * own_.model->gear_ratio * own_.pole_pairs;
  writeBigEndian(data, 0, int16Of(driveAngleDeg() * own_.message_deg_per_deg * 10.0, 32000.0));
  writeBigEndian(data, 2, int16Of(erpm / 10.0, 32000.0));
  writeBigEndian(data, 4, int16Of(amperes * 100.0, 32000.0));
  data[6] = static_cast<std::uint8_t>(std::lround(std::clamp(physics().temperatureC(), -20.0, 127.0)));
  data[7] = error_;
  return makeClassicFrame(cubemars::servoFeedbackId(id_), data);
}

CanFrame CubemarsDrive::mitReply() const noexcept {
  const auto& r = own_.ranges;
  std::array<std::uint8_t, 8> data{};
  // Scaled without limits (float_to_uint() of the Mini Cheetah's firmware, from which this protocol is).
  const std::uint32_t position = wrappedCode(driveAngleDeg() * kRadPerDeg, r.position_rad, 16);
  const std::uint32_t velocity = wrappedCode(driveRpm() * kRadPerSPerRpm, r.velocity_rad_s, 12);
  const std::uint32_t torque = wrappedCode(driveTorqueNm(), r.torque_nm, 12);
  data[0] = static_cast<std::uint8_t>(id_);
  writeBigEndian(data, 1, static_cast<std::uint16_t>(position));
  data[3] = static_cast<std::uint8_t>(velocity >> 4U);
  data[4] = static_cast<std::uint8_t>((velocity & 0xFU) << 4U | torque >> 8U);
  data[5] = static_cast<std::uint8_t>(torque & 0xFFU);
  data[6] = static_cast<std::uint8_t>(std::lround(std::clamp(physics().temperatureC(), -40.0, 215.0)) + 40);
  data[7] = error_;
  return makeClassicFrame({0, false}, data);
}

std::unique_ptr<Drive> makeCubemarsDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<CubemarsDrive>(settings, cubemarsSettings(settings.model, settings.own), load);
}

}  // namespace rc10::sim
