#include "drives/myactuator/myactuator_simulated.hpp"

#include <algorithm>
#include <cmath>

#include "app/saturated.hpp"
#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_model.hpp"

namespace rc10::sim {
namespace {

constexpr double kMyactuatorRawPerDeg = 100.0;
constexpr double kRawPerAmpere = 100.0;
constexpr double kMyactuatorRawPerVolt = 10.0;
// Chosen: no source tells how long it starts.
constexpr Duration kMyactuatorBootTime = std::chrono::milliseconds{300};
constexpr Duration kNoticeSpacing = std::chrono::seconds{1};

std::uint32_t rawOf(double value, double low, double high, unsigned bits) noexcept {
  const double full_scale = static_cast<double>((1U << bits) - 1U);
  const double inside = std::clamp(value, low, high);
  return saturatedRound<std::uint32_t>((inside - low) / (high - low) * full_scale);
}

constexpr double valueOf(std::uint32_t raw, double low, double high, unsigned bits) noexcept {
  return low + static_cast<double>(raw) * (high - low) / static_cast<double>((1U << bits) - 1U);
}

std::vector<FrameFilter> replyIds(int id) {
  const auto n = static_cast<std::uint32_t>(id);
  return {{.id = {myactuator::kReplyBase + n, false}, .mask = kStandardIdMask},
          {.id = {myactuator::kMotionReplyBase + n, false}, .mask = kStandardIdMask}};
}

}  // namespace

MyactuatorDrive::MyactuatorDrive(const MotorSettings& settings, const MotorTraits& traits,
                                 const MotorLoad& load)
    : ServoDrive(settings, traits, load, replyIds(settings.id)), id_(settings.id) {
  zeroAt(std::fmod(driveAngleDeg(), kDegPerTurn));
}

CanFrame MyactuatorDrive::reply(myactuator::Code code) const noexcept {
  CanFrame frame;
  frame.id = {myactuator::kReplyBase + static_cast<std::uint32_t>(id_), false};
  frame.length = myactuator::kLength;
  frame.data[0] = static_cast<std::uint8_t>(code);
  return frame;
}

void MyactuatorDrive::receive(const CanFrame& frame) noexcept {
  if (booting() || frame.type != FrameType::kData || frame.fd || frame.id.extended) return;
  if (frame.length != myactuator::kLength) return;
  const auto n = static_cast<std::uint32_t>(id_);
  const bool request =
      frame.id.value == myactuator::kRequestBase + n || frame.id.value == myactuator::kBroadcastId;
  const bool motion = frame.id.value == myactuator::kMotionBase + n;
  if (!request && !motion) return;
  heard_ = elapsed();
  if (silence_stopped_) {  // the first frame only ends the silence
    silence_stopped_ = false;
    CanFrame copy = frame;
    copy.id = reply(myactuator::Code::kReset).id;
    return answer(copy);
  }
  motion ? obeyMotion(frame) : obey(frame);
}

void MyactuatorDrive::obey(const CanFrame& frame) noexcept {
  const auto payload = frame.payload();
  const myactuator::Code code = myactuator::codeOf(payload);
  const bool able = errors_ == 0;
  switch (code) {
    case myactuator::Code::kReset: return restart();
    case myactuator::Code::kReleaseBrake: brake_released_ = true; return answer(reply(code));
    case myactuator::Code::kShutdown: release(); return answer(reply(code));
    case myactuator::Code::kStop:
      if (able) velocity(0.0);
      return answer(reply(code));
    case myactuator::Code::kAngle: {
      CanFrame out = reply(code);
      writeLittleEndian(out.data, 4, saturatedRound<std::int32_t>(driveAngleDeg() * kMyactuatorRawPerDeg));
      return answer(out);
    }
    case myactuator::Code::kStatus: return answerStatus();
    case myactuator::Code::kReading: return answerReading(code);
    case myactuator::Code::kUptime: {
      CanFrame out = reply(code);
      const auto run = std::chrono::duration_cast<std::chrono::milliseconds>(elapsed() - started_);
      writeLittleEndian(out.data, 4, static_cast<std::uint32_t>(run.count()));
      return answer(out);
    }
    case myactuator::Code::kCurrent:
      if (able) current(readLittleEndian<std::int16_t>(payload, 4) / kRawPerAmpere);
      return answerReading(code);
    case myactuator::Code::kVelocity:
      if (able) velocity(readLittleEndian<std::int32_t>(payload, 4) / kMyactuatorRawPerDeg / kDegPerSPerRpm);
      return answerReading(code);
    case myactuator::Code::kPosition:
      if (able) {
        position(readLittleEndian<std::int32_t>(payload, 4) / kMyactuatorRawPerDeg,
                 readLittleEndian<std::uint16_t>(payload, 2) / kDegPerSPerRpm);
      }
      return answerReading(code);
    case myactuator::Code::kFunction:
    case myactuator::Code::kReadAcceleration:
    case myactuator::Code::kSetAcceleration:
    case myactuator::Code::kSilenceLimit: return set(frame);
    case myactuator::Code::kSilenceStopped: break;
  }
}

// All of it is stored at once; the answer is a copy.
void MyactuatorDrive::set(const CanFrame& frame) noexcept {
  const auto value = readLittleEndian<std::uint32_t>(frame.data, 4);
  const std::uint8_t index = frame.data[1];
  CanFrame out = frame;
  out.id = reply(myactuator::Code::kFunction).id;
  switch (myactuator::codeOf(frame.payload())) {
    case myactuator::Code::kSilenceLimit: silence_limit_ = std::chrono::milliseconds{value}; break;
    case myactuator::Code::kReadAcceleration:
      if (index < accelerations_.size()) writeLittleEndian(out.data, 4, accelerations_[index]);
      break;
    case myactuator::Code::kSetAcceleration:
      if (index < accelerations_.size()) accelerations_[index] = std::clamp(value, 100U, 60'000U);
      break;
    default:
      if (index == 5) id_ = static_cast<int>(value & 0x3FU);
      break;
  }
  answer(out);
}

void MyactuatorDrive::obeyMotion(const CanFrame& frame) noexcept {
  const auto& d = frame.data;
  const auto word = [&d](std::size_t at) { return static_cast<std::uint32_t>(d[at]); };
  using namespace myactuator;
  const double angle_rad = valueOf(word(0) << 8U | word(1), -kMotionAngleRad, kMotionAngleRad, 16);
  const double rad_s = valueOf(word(2) << 4U | word(3) >> 4U, -kMotionVelocityRadS, kMotionVelocityRadS, 12);
  const double stiffness = valueOf((word(3) & 0xFU) << 8U | word(4), 0.0, kMotionStiffness, 12);
  const double damping = valueOf(word(5) << 4U | word(6) >> 4U, 0.0, kMotionDamping, 12);
  const double torque_nm = valueOf((word(6) & 0xFU) << 8U | word(7), -kMotionTorqueNm, kMotionTorqueNm, 12);
  if (errors_ == 0) impedance(angle_rad / kRadPerDeg, rad_s / kRadPerSPerRpm, stiffness, damping, torque_nm);
  answerMotion();
}

void MyactuatorDrive::answerReading(myactuator::Code code) noexcept {
  CanFrame out = reply(code);
  out.data[1] = static_cast<std::uint8_t>(saturatedRound<std::int8_t>(physics().temperatureC()));
  writeLittleEndian(out.data, 2, saturatedRound<std::int16_t>(currentA() * kRawPerAmpere));
  writeLittleEndian(out.data, 4, saturatedRound<std::int16_t>(driveRpm() * kDegPerSPerRpm));
  writeLittleEndian(out.data, 6, saturatedRound<std::int16_t>(driveAngleDeg()));
  answer(out);
}

void MyactuatorDrive::answerMotion() noexcept {
  using namespace myactuator;
  CanFrame out;
  out.id = {kMotionReplyBase + static_cast<std::uint32_t>(id_), false};
  out.length = kLength;
  out.data[0] = static_cast<std::uint8_t>(id_);
  const auto angle = rawOf(driveAngleDeg() * kRadPerDeg, -kMotionAngleRad, kMotionAngleRad, 16);
  const auto speed = rawOf(driveRpm() * kRadPerSPerRpm, -kMotionVelocityRadS, kMotionVelocityRadS, 12);
  const auto nm = rawOf(driveTorqueNm(), -kMotionTorqueNm, kMotionTorqueNm, 12);
  writeBigEndian(out.data, 1, static_cast<std::uint16_t>(angle));
  out.data[3] = static_cast<std::uint8_t>(speed >> 4U);
  out.data[4] = static_cast<std::uint8_t>((speed & 0xFU) << 4U | nm >> 8U);
  out.data[5] = static_cast<std::uint8_t>(nm & 0xFFU);
  answer(out);
}

void MyactuatorDrive::answerStatus() noexcept {
  CanFrame out = reply(myactuator::Code::kStatus);
  out.data[1] = static_cast<std::uint8_t>(saturatedRound<std::int8_t>(physics().temperatureC()));
  out.data[3] = brake_released_ ? 1 : 0;
  writeLittleEndian(out.data, 4,
                    saturatedRound<std::uint16_t>(physics().parameters().supply_v * kMyactuatorRawPerVolt));
  writeLittleEndian(out.data, 6, errors_);
  answer(out);
}

void MyactuatorDrive::step(Duration dt) noexcept {
  ServoDrive::step(dt);
  if (silence_limit_ == Duration::zero() || booting()) return;
  if (!silence_stopped_ && elapsed() - heard_ > silence_limit_) {
    silence_stopped_ = true;
    release();
    next_notice_ = elapsed();
  }
  if (silence_stopped_ && elapsed() >= next_notice_) {
    next_notice_ = elapsed() + kNoticeSpacing;
    answer(reply(myactuator::Code::kSilenceStopped));
  }
}

void MyactuatorDrive::restart() noexcept {
  release();
  // With one encoder it knows where within a turn of the rotor it is, with two within a turn of the output.
  zeroAt(std::fmod(driveAngleDeg(), traits().absolute ? kDegPerTurn : kDegPerTurn / traits().gear_ratio));
  started_ = elapsed();
  boots_until_ = elapsed() + kMyactuatorBootTime;
  heard_ = boots_until_;
  silence_stopped_ = false;
  brake_released_ = false;
  errors_ = cause_;
}

void MyactuatorDrive::fault(std::uint32_t native_code) noexcept {
  cause_ = static_cast<std::uint16_t>(native_code);
  std::uint16_t kept = 0;
  for (const auto& known : myactuatorFaults()) {
    if (known.needs_restart) kept = static_cast<std::uint16_t>(kept | (errors_ & known.native));
  }
  errors_ = static_cast<std::uint16_t>(cause_ | kept);
  if (errors_ != 0) release();
}

std::unique_ptr<Drive> makeMyactuatorDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<MyactuatorDrive>(settings, myactuatorFamily().traits(settings.model, settings.own),
                                           load);
}

}  // namespace rc10::sim
