#include "acme_motor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "acme_loop_motor.hpp"
#include "bus/byte_order.hpp"

namespace acme {
namespace {

using namespace rc10;

constexpr std::uint32_t kCommandBase = 0x300;
constexpr std::uint32_t kFeedbackBase = 0x380;
constexpr std::size_t kLength = 8;
constexpr double kDegreesPerCount = 0.01;
constexpr double kRpmPerCount = 0.1;
constexpr double kAmperesPerCount = 0.001;
constexpr std::uint8_t kEnabledFlag = 1U << 0U;

/// The drive's fault codes, in the words that all families share.
constexpr std::array kFaults{FaultCode::kNone, FaultCode::kDriveOverCurrent, FaultCode::kDriveTooHot,
                             FaultCode::kDriveEncoder};

[[nodiscard]] std::uint8_t faultOf(std::uint8_t flags) noexcept {
  return static_cast<std::uint8_t>((flags >> 1U) & 3U);
}

/// To an int16 that saturates instead of wrapping.
[[nodiscard]] std::int16_t counts(double value, double per_count) noexcept {
  constexpr double kMost = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::lround(std::clamp(value / per_count, -kMost, kMost)));
}

[[nodiscard]] CanId commandId(int id) noexcept {
  return {kCommandBase + static_cast<std::uint32_t>(id), false};
}
[[nodiscard]] CanId feedbackId(int id) noexcept {
  return {kFeedbackBase + static_cast<std::uint32_t>(id), false};
}

constexpr std::string_view kLoopModel = "Turner-C";

/// Default gains of the Turner-C. 200 samples a second allow a velocity loop of some 10 Hz.
constexpr CascadeConfig kLoops{.velocity = PID_Position::Config{.kp = 0.05F, .ki = 0.5F},
                               .angle = {.kp = 1.0F}};

constexpr FrameShape kShape{.extended = false, .fd = false, .bit_rate_switch = false, .length = kLength};

class AcmeFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "ACME"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override {
    static constexpr std::array<std::string_view, 2> kModels{"Turner", kLoopModel};
    return kModels;
  }

  [[nodiscard]] MotorTraits traits(std::string_view model, const OwnValues& /*own*/) const override {
    MotorTraits traits;
    traits.min_id = 1;
    traits.max_id = 16;
    traits.gear_ratio = 10.0;
    traits.effort_full_scale = 20.0F;
    traits.torque_nm_per_a = 0.5F;
    traits.no_load_rpm = 300.0F;
    traits.feedback_hz = 200;
    traits.max_feedback_hz = 500;
    traits.watchdog = true;
    traits.modes =
        ModeSet{ControlMode::kCoast, ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kBrake};
    traits.frames = {.rest = Provision::kFrame,
                     .idle = Provision::kFrame,
                     .brake = Provision::kFrame,  // velocity 0
                     .enable = Provision::kFrame};
    if (model == kLoopModel) {
      traits.host_loops = &kLoops;
      traits.modes = ModeSet{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                             ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kBrake};
      traits.frames.brake = traits.frames.hold = Provision::kHostLoop;
    } else {
      traits.unseen_limit_remedy = "it reports no current; take a Turner-C";
    }
    return traits;
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const double commands_per_s = static_cast<double>(settings.tick_hz) / settings.command_divider;
    BusUse use;
    use.sends = {FrameFilter{.id = feedbackId(settings.id)}};
    use.obeys = {FrameFilter{.id = commandId(settings.id)}};
    use.feedback = {{feedbackId(settings.id), kShape, static_cast<double>(settings.feedback_hz)}};
    use.commands = {{commandId(settings.id), kShape, commands_per_s}};
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    const MotorTraits of_model = traits(settings.model, settings.own);
    if (of_model.host_loops != nullptr) {
      return registerSolo(std::make_unique<ACME_LoopMotor>(settings, of_model), parts);
    }
    return registerSolo(std::make_unique<ACME_Motor>(settings, of_model), parts);
  }
};

}  // namespace

// Rotor turns for one turn of the output shaft: the drive reports its rotor.
ACME_Motor::ACME_Motor(const MotorSettings& settings, const MotorTraits& traits)
    : SoloMotor(settings, traits, gearRatioOf(settings, traits)),
      filters_{FrameFilter{.id = feedbackId(settings.id)}},
      command_ids_{commandId(settings.id)} {}

bool ACME_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  return frame.id == filters_[0].id && frame.type == FrameType::kData && !frame.fd;
}

FrameVerdict ACME_Motor::updateFeedback(const CanFrame& frame) noexcept {
  if (frame.length != kLength) return FrameVerdict::kMalformed;
  const auto bytes = frame.payload();
  acceptSample(frame.received, readLittleEndian<std::int32_t>(bytes, 0) * kDegreesPerCount);
  feedback_.velocity_rpm =
      static_cast<float>(toOutput(readLittleEndian<std::int16_t>(bytes, 4) * kRpmPerCount));
  feedback_.temperature_c = static_cast<float>(bytes[6]);
  flags_ = bytes[7];
  return FrameVerdict::kAccepted;
}

void ACME_Motor::update(const Tick& /*tick*/) noexcept {
  limits_ = 0;
  const Target target = wanted();
  switch (target.mode) {
    case ControlMode::kVelocity:
    case ControlMode::kBrake: return obeyVelocity(rpmWithinLimit(target.value));
    case ControlMode::kCurrent: return obeyCurrent(currentWithinLimit(target));
    default: return obeyCurrent(0.0);
  }
}

// On while it is to be enabled or to obey: then without torque until there is a target.
void ACME_Motor::obeyCurrent(double current_a) noexcept {
  mode_ = enabling() || obeying() ? Mode::kCurrent : Mode::kOff;
  current_a_ = current_a;
  velocity_rpm_ = 0.0;
  setCommand(current_a, CommandUnit::kAmpere);
}

void ACME_Motor::obeyVelocity(double output_rpm) noexcept {
  mode_ = Mode::kVelocity;
  current_a_ = 0.0;
  velocity_rpm_ = toDrive(output_rpm);
  setCommand(output_rpm, CommandUnit::kNative);
}

SequenceProgress ACME_Motor::sequenceProgress() const noexcept {
  return (flags_ & kEnabledFlag) != 0 ? SequenceProgress::kDone : SequenceProgress::kPending;
}

DriveComplaint ACME_Motor::complaint() const noexcept {
  if (const auto fault = faultOf(flags_); fault != 0) return {kFaults[fault], fault};
  if (obeying() && (flags_ & kEnabledFlag) == 0) return {FaultCode::kDriveStopped, 0};
  return {};
}

CanFrame ACME_Motor::frame(Mode mode, double current_a, double velocity_rpm) const noexcept {
  std::array<std::uint8_t, kLength> bytes{};
  bytes[0] = static_cast<std::uint8_t>(mode);
  // The drive turns the other way round where the motor is mounted so.
  writeLittleEndian(bytes, 2, counts(current_a * static_cast<double>(direction()), kAmperesPerCount));
  writeLittleEndian(bytes, 4, counts(velocity_rpm, kRpmPerCount));
  return makeClassicFrame(command_ids_[0], bytes);
}

std::size_t ACME_Motor::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  if (!due(tick)) return 0;
  const bool clears = clear_ && mode_ == Mode::kOff;
  out[0] = clears ? frame(Mode::kClear, 0.0, 0.0) : frame(mode_, current_a_, velocity_rpm_);
  if (clears) clear_ = false;
  return 1;
}

std::size_t ACME_Motor::packRest(std::span<CanFrame> out) const noexcept {
  out[0] = frame(Mode::kOff, 0.0, 0.0);
  return 1;
}

const MotorFamily& acmeFamily() noexcept {
  static const AcmeFamily kFamily;
  return kFamily;
}

}  // namespace acme
