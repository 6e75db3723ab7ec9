#include "drives/robstride/robstride_simulated.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "app/angle.hpp"
#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "drives/robstride/robstride_family.hpp"

namespace rc10::sim {
namespace {

namespace parameter = robstride::parameter;

constexpr double kFarthestRad = 1e9;
constexpr std::uint32_t kLongestTimeout = 100'000;
// Parameters that are only kept.
constexpr std::uint16_t kReportInterval = 0x7026;
constexpr std::uint16_t kZeroRange = 0x7029;
constexpr std::uint16_t kPositionKp = 0x701E;
constexpr std::uint16_t kVelocityKp = 0x701F;
constexpr std::uint16_t kVelocityKi = 0x7020;
constexpr double kMostGain = 1e6;
// "rc10 sim"
constexpr std::array<std::uint8_t, 8> kUniqueId{0x72, 0x63, 0x31, 0x30, 0x20, 0x73, 0x69, 0x6D};

std::uint32_t bitsOf(double value) noexcept {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

/// Which status bit of the feedback goes with which bits of the fault word.
struct StatusBit {
  std::uint32_t fault_bits;
  std::uint8_t status_bit;
};
constexpr std::array kStatusBits{StatusBit{1U << 2U, 0}, StatusBit{0x1'0030U, 1}, StatusBit{1U << 0U, 2},
                                 StatusBit{1U << 9U, 3}, StatusBit{1U << 14U, 4}, StatusBit{1U << 7U, 5}};

robstride::Codec codecOf(const MotorSettings& settings, const RobstrideModel& model) {
  const double range_rad = settings.own.number("position_range_rad");
  return {.model = &model,
          .position_range_rad = range_rad > 0.0 ? range_rad : model.position_range_rad,
          .drive_id = settings.id,
          .host_id = settings.own.integer("host_id")};
}

}  // namespace

RobstrideDrive::RobstrideDrive(const MotorSettings& settings, const MotorLoad& load)
    : ServoDrive(settings, robstrideFamily().traits(settings.model, settings.own), load,
                 robstrideFamily().busUse(settings).sends),
      model_(findRobstrideModel(settings.model)),
      codec_(codecOf(settings, *model_)),
      parameters_{{{.index = parameter::kRunMode, .integer = true, .limit = 5.0},
                   {.index = model_->watchdog_index, .integer = true, .limit = kLongestTimeout},
                   {.index = parameter::kCurrentRef, .limit = model_->max_current_a},
                   {.index = parameter::kVelocityRef, .limit = model_->velocity_range_rad_s},
                   {.index = parameter::kTorqueLimit,
                    .limit = model_->torque_range_nm,
                    .at_power_up = bitsOf(model_->torque_range_nm)},
                   {.index = parameter::kPositionRef, .limit = kFarthestRad},
                   {.index = parameter::kVelocityLimit,
                    .limit = model_->velocity_range_rad_s,
                    .at_power_up = bitsOf(2.0)},
                   {.index = parameter::kCurrentLimit,
                    .limit = model_->max_current_a,
                    .at_power_up = bitsOf(model_->max_current_a)},
                   {.index = kReportInterval, .integer = true, .limit = 0xFFFF, .at_power_up = 1},
                   {.index = kZeroRange, .integer = true, .limit = 1},
                   {.index = kPositionKp, .limit = kMostGain},
                   {.index = kVelocityKp, .limit = kMostGain},
                   {.index = kVelocityKi, .limit = kMostGain}}} {
  powerUp();
}

RobstrideDrive::Parameter* RobstrideDrive::find(std::uint16_t index) noexcept {
  auto* const found = std::find_if(parameters_.begin(), parameters_.end(),
                                   [index](const Parameter& each) { return each.index == index; });
  return found != parameters_.end() ? found : nullptr;
}

double RobstrideDrive::number(std::uint16_t index) noexcept {
  return static_cast<double>(std::bit_cast<float>(find(index)->bits));
}

// Where it stands within a turn of its output; a CyberGear knows it within a turn of its rotor only.
void RobstrideDrive::powerUp() noexcept {
  for (auto& each : parameters_) each.bits = each.at_power_up;
  running_ = false;
  operation_ = {};
  fault_word_ = 0;
  status_bits_ = 0;
  release();
  const double turn_deg = model_->absolute ? kDegPerTurn : kDegPerTurn / model_->gear_ratio;
  zeroAt(wrapPeriod(driveAngleDeg(), turn_deg));
}

void RobstrideDrive::restart() noexcept { powerUp(); }

void RobstrideDrive::fault(std::uint32_t native_code) noexcept {
  fault_word_ = native_code & 0x00FF'FFFFU;
  status_bits_ = static_cast<std::uint8_t>(native_code >> 24U & 0x3FU);
  for (const auto& [fault_bits, status_bit] : kStatusBits) {
    if ((fault_word_ & fault_bits) != 0) status_bits_ |= static_cast<std::uint8_t>(1U << status_bit);
  }
  if (native_code == 0) return;
  stop();
  if (fault_word_ != 0) answer(codec_.fault(fault_word_));
}

void RobstrideDrive::receive(const CanFrame& frame) noexcept {
  const bool mine = frame.id.extended && !frame.fd && frame.type == FrameType::kData && frame.length == 8 &&
                    (frame.id.value & 0xFFU) == static_cast<std::uint32_t>(codec_.drive_id);
  if (!mine || stores()) return;
  heard_at_ = elapsed();
  const auto bytes = frame.payload();
  const auto type = static_cast<robstride::Type>(frame.id.value >> 24U & 0x1FU);
  // Answers go to whoever asked last; an operation command has its torque where others have that.
  if (type != robstride::Type::kOperate) codec_.host_id = static_cast<int>(frame.id.value >> 8U & 0xFFU);
  switch (type) {
    case robstride::Type::kGetId: answer(codec_.identity(kUniqueId)); return;
    case robstride::Type::kOperate:
      if (running_ && find(parameter::kRunMode)->bits == 0) {
        operation_ = codec_.operation(frame);
        follow();
      }
      break;
    case robstride::Type::kEnable: enable(); break;
    case robstride::Type::kStop:
      if (bytes[0] == 1) fault(0);
      stop();
      break;
    case robstride::Type::kSetZero:
      if (bytes[0] == 1) zeroAt(0.0);
      break;
    case robstride::Type::kSetId:
      codec_.drive_id = static_cast<int>(frame.id.value >> 16U & 0x7FU);
      answer(codec_.identity(kUniqueId));  // as the one that it is now
      return;
    case robstride::Type::kWriteParameter: write(frame); break;
    case robstride::Type::kSave: save(); break;
    case robstride::Type::kReadParameter: read(readLittleEndian<std::uint16_t>(bytes, 0)); return;
    default: return;
  }
  answerState();
}

void RobstrideDrive::enable() noexcept {
  if (fault_word_ != 0 || status_bits_ != 0 || running_) return;
  running_ = true;
  follow();
}

void RobstrideDrive::stop() noexcept {
  running_ = false;
  release();
}

void RobstrideDrive::write(const CanFrame& frame) noexcept {
  auto* const found = find(readLittleEndian<std::uint16_t>(frame.payload(), 0));
  if (found == nullptr) return;
  const auto bits = readLittleEndian<std::uint32_t>(frame.payload(), 4);
  if (found->index == parameter::kRunMode) {
    if (!running_) found->bits = std::min(bits & 0xFFU, 5U);
  } else if (found->integer) {
    found->bits = std::min(bits, static_cast<std::uint32_t>(found->limit));
  } else {
    const auto value = static_cast<double>(std::bit_cast<float>(bits));
    if (std::isfinite(value)) found->bits = bitsOf(std::clamp(value, -found->limit, found->limit));
  }
  if (running_) follow();
}

// Run mode and references are no settings: they start anew.
void RobstrideDrive::save() noexcept {
  if (model_->cyber_gear) return;
  store();
  for (auto& each : parameters_) {
    const bool reference = each.index == parameter::kRunMode || each.index == parameter::kCurrentRef ||
                           each.index == parameter::kVelocityRef || each.index == parameter::kPositionRef;
    if (!reference) each.at_power_up = each.bits;
  }
}

void RobstrideDrive::read(std::uint16_t index) noexcept {
  if (index == parameter::kPosition) {
    answer(codec_.parameter(index, bitsOf(driveAngleDeg() / kDegPerRad), true));
  } else if (index == parameter::kSupplyVoltage) {
    answer(codec_.parameter(index, bitsOf(physics().parameters().supply_v), true));
  } else if (const auto* found = find(index); found != nullptr) {
    answer(codec_.parameter(index, found->bits, true));
  } else {
    answer(codec_.parameter(index, 0, false));
  }
}

void RobstrideDrive::follow() noexcept {
  const auto run_mode = find(parameter::kRunMode)->bits;
  const double torque_nm = std::max(number(parameter::kCurrentLimit), 0.0) * model_->torqueNmPerA();
  if (run_mode == static_cast<std::uint32_t>(robstride::RunMode::kOperation)) {
    impedance(operation_.position_rad * kDegPerRad, operation_.velocity_rad_s * kRpmPerRadPerS,
              operation_.stiffness_nm_per_rad, operation_.damping_nms_per_rad, operation_.torque_nm);
  } else if (run_mode == static_cast<std::uint32_t>(robstride::RunMode::kCurrent)) {
    current(number(parameter::kCurrentRef));
  } else if (torque_nm <= 0.0) {
    release();  // to the base a limit of 0 is none
  } else if (run_mode == static_cast<std::uint32_t>(robstride::RunMode::kVelocity)) {
    velocity(number(parameter::kVelocityRef) * kRpmPerRadPerS, 0.0, torque_nm);
  } else {
    position(number(parameter::kPositionRef) * kDegPerRad,
             std::max(number(parameter::kVelocityLimit), 0.0) * kRpmPerRadPerS, torque_nm);
  }
}

void RobstrideDrive::answerState() noexcept {
  robstride::Feedback state;
  constexpr double kTwoTurnsRad = 2.0 * kRadPerTurn;
  const double position_rad = driveAngleDeg() / kDegPerRad;
  // The older scale of 12.5 rad ends; the newer one goes on.
  const bool wraps = std::abs(codec_.position_range_rad - kTwoTurnsRad) < 0.02;
  state.position_rad =
      wraps ? wrapPeriod(position_rad + kTwoTurnsRad, 2.0 * kTwoTurnsRad) - kTwoTurnsRad : position_rad;
  state.velocity_rad_s = driveRpm() / kRpmPerRadPerS;
  state.torque_nm = driveTorqueNm();
  state.temperature_c = physics().temperatureC();
  state.status_bits = status_bits_;
  state.mode = running_ ? robstride::kRunning : 0;
  answer(codec_.answer(state));
}

void RobstrideDrive::step(Duration dt) noexcept {
  ServoDrive::step(dt);
  const Duration timeout = std::chrono::microseconds{50} * find(model_->watchdog_index)->bits;
  if (running_ && timeout > Duration::zero() && elapsed() - heard_at_ > timeout) stop();
}

std::unique_ptr<Drive> makeRobstrideDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<RobstrideDrive>(settings, load);
}

}  // namespace rc10::sim
