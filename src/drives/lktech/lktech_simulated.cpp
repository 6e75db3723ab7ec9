#include "drives/lktech/lktech_simulated.hpp"

#include <algorithm>
#include <cmath>

#include "app/angle.hpp"
#include "app/saturated.hpp"
#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "drives/lktech/lktech_family.hpp"
#include "drives/lktech/lktech_model.hpp"

namespace rc10::sim {
namespace {

constexpr double kLktechRawPerDeg = 100.0;
constexpr double kLktechRawPerVolt = 100.0;
constexpr std::uint8_t kOffState = 0x10;
// Chosen: no source tells how long it starts.
constexpr Duration kLktechBootTime = std::chrono::milliseconds{300};

}  // namespace

LktechDrive::LktechDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load)
    : ServoDrive(settings, traits, load,
                 {{.id = {lktech::kBaseId + static_cast<std::uint32_t>(settings.id), false},
                   .mask = kStandardIdMask}}),
      id_(settings.id),
      encoder_counts_(1U << static_cast<unsigned>(settings.own.integer("encoder_bits"))) {
  if (const auto* model = findLktechModel(settings.model)) amperes_per_raw_ = model->amperes_per_raw;
  forgetTurns();
}

// Where it is within a turn of the output, it knows.
void LktechDrive::forgetTurns() noexcept { zeroAt(wrapDegrees(driveAngleDeg())); }

CanFrame LktechDrive::reply(lktech::Code code) const noexcept { return lktech::request(id_, code); }

void LktechDrive::receive(const CanFrame& frame) noexcept {
  if (elapsed() < boots_until_ || frame.type != FrameType::kData || frame.fd || frame.id.extended) return;
  if (frame.length != lktech::kLength) return;
  if (frame.id.value == lktech::kBaseId + static_cast<std::uint32_t>(id_)) return obey(frame);
  if (frame.id.value == lktech::kGroupId && id_ <= lktech::kGroupSize) {
    const auto slot = static_cast<std::size_t>(id_ - 1);
    if (able()) current(readLittleEndian<std::int16_t>(frame.payload(), 2 * slot) * amperes_per_raw_);
    answerReading(lktech::Code::kCurrent);
  }
}

void LktechDrive::obey(const CanFrame& frame) noexcept {
  const auto payload = frame.payload();
  const lktech::Code code = lktech::codeOf(payload);
  const double gear = traits().gear_ratio;
  const auto angle_or_speed = readLittleEndian<std::int32_t>(payload, 4) / kLktechRawPerDeg / gear;
  switch (code) {
    case lktech::Code::kOff:
      on_ = false;
      release();
      forgetTurns();
      return answer(reply(code));
    case lktech::Code::kStop: release(); return answer(reply(code));
    case lktech::Code::kOn: on_ = true; return answer(reply(code));
    case lktech::Code::kAngle: {
      CanFrame out = reply(code);
      const auto raw = static_cast<std::int64_t>(std::llround(driveAngleDeg() * gear * kLktechRawPerDeg));
      for (std::size_t i = 0; i < 7; ++i) {
        out.data[1 + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(raw) >> (8U * i) & 0xFFU);
      }
      return answer(out);
    }
    case lktech::Code::kClear: errors_ = cause_; return answerStatus(code);
    case lktech::Code::kStatus: return answerStatus(code);
    case lktech::Code::kReading: return answerReading(code);
    case lktech::Code::kCurrent:
      if (able()) current(readLittleEndian<std::int16_t>(payload, 4) * amperes_per_raw_);
      return answerReading(code);
    case lktech::Code::kVelocity:
      if (able()) {
        const double limit_a = std::abs(readLittleEndian<std::int16_t>(payload, 2)) * amperes_per_raw_;
        const double nm_per_a = physics().parameters().torque_nm_per_a * gear;
        velocity(angle_or_speed / kDegPerSPerRpm, 0.0, limit_a * nm_per_a);
      }
      return answerReading(code);
    case lktech::Code::kPosition:
      if (able())
        position(angle_or_speed, readLittleEndian<std::uint16_t>(payload, 2) / kDegPerSPerRpm / gear);
      return answerReading(code);
  }
}

void LktechDrive::answerReading(lktech::Code code) noexcept {
  CanFrame out = reply(code);
  out.data[1] = static_cast<std::uint8_t>(saturatedRound<std::int8_t>(physics().temperatureC()));
  writeLittleEndian(out.data, 2, saturatedRound<std::int16_t>(currentA() / amperes_per_raw_));
  writeLittleEndian(out.data, 4,
                    saturatedRound<std::int16_t>(driveRpm() * kDegPerSPerRpm * traits().gear_ratio));
  const double turns = wrapDegrees(driveAngleDeg()) / kDegPerTurn;
  const auto encoder = static_cast<std::uint32_t>(turns * encoder_counts_) % encoder_counts_;
  writeLittleEndian(out.data, 6, static_cast<std::uint16_t>(encoder));
  answer(out);
}

void LktechDrive::answerStatus(lktech::Code code) noexcept {
  CanFrame out = reply(code);
  out.data[1] = static_cast<std::uint8_t>(saturatedRound<std::int8_t>(physics().temperatureC()));
  writeLittleEndian(out.data, 2,
                    saturatedRound<std::uint16_t>(physics().parameters().supply_v * kLktechRawPerVolt));
  out.data[6] = on_ ? 0 : kOffState;
  out.data[7] = errors_;
  answer(out);
}

void LktechDrive::restart() noexcept {
  release();
  forgetTurns();
  on_ = true;
  errors_ = cause_;
  boots_until_ = elapsed() + kLktechBootTime;
}

void LktechDrive::fault(std::uint32_t native_code) noexcept {
  cause_ = static_cast<std::uint8_t>(native_code);
  errors_ = static_cast<std::uint8_t>(errors_ | cause_);
  if (errors_ != 0) release();
}

std::unique_ptr<Drive> makeLktechDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<LktechDrive>(settings, lktechFamily().traits(settings.model, settings.own), load);
}

}  // namespace rc10::sim
