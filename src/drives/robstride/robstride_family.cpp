#include "drives/robstride/robstride_family.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "app/units.hpp"
#include "drives/robstride/robstride_motor.hpp"

namespace rc10 {
namespace {

constexpr std::array<std::string_view, 4> kControls{"operation", "current", "velocity", "position"};

constexpr std::array kRobstrideKeys{
    OwnKey{.name = "host_id",
           .kind = OwnKey::Kind::kInteger,
           .min = 1,
           .max = 254,
           .default_text = "253",
           .about = "The id to which the drive answers; no drive on the bus may have it."},
    OwnKey{.name = "control",
           .kind = OwnKey::Kind::kChoice,
           .choices = kControls,
           .default_text = "operation",
           .about = "operation: stiffness, damping and torque in every frame. Or one of the drive's own "
                    "current, velocity and position loops."},
    OwnKey{.name = "position_range_rad",
           .kind = OwnKey::Kind::kNumber,
           .unit = "rad",
           .min = 0,
           .max = 13,
           .default_text = "0",
           .about =
               "End of the drive's position scale. 0: the model's own, 12.57, CyberGear 12.5. Write 12.5 "
               "for RS firmware before 0.0.2.6 (RS02: up to 0.2.2.11): else angles are 0.5 % too large."},
    OwnKey{
        .name = "angle_stiffness_nm_per_rad",
        .kind = OwnKey::Kind::kNumber,
        .unit = "Nm/rad",
        .min = 0,
        .max = 1e6,
        .default_text = "0",
        .about =
            "Torque per angle error of angle targets, control operation. 0: full torque at half a radian."},
    OwnKey{.name = "angle_damping_nms_per_rad",
           .kind = OwnKey::Kind::kNumber,
           .unit = "Nms/rad",
           .min = 0,
           .max = 1e5,
           .default_text = "0",
           .about = "Torque per speed error of angle targets, control operation. 0: 0.035 s times the "
                    "default stiffness."},
    OwnKey{.name = "velocity_gain_nms_per_rad",
           .kind = OwnKey::Kind::kNumber,
           .unit = "Nms/rad",
           .min = 0,
           .max = 1e5,
           .default_text = "0",
           .about = "Torque per speed error of velocity targets and brake, control operation; damp has a "
                    "fifth of it. 0: full torque at 5 rad/s, or the scale's end."},
    OwnKey{.name = "watchdog_ms",
           .kind = OwnKey::Kind::kInteger,
           .unit = "ms",
           .min = 0,
           .max = 5000,
           .default_text = "200",
           .about = "The drive's own watchdog: it goes without torque after so long without a frame; set "
                    "and read back when it is enabled. 0: leave the drive's setting alone."},
};

constexpr double kShortestPositionRangeRad = 12.0;
constexpr int kCommandsPerWatchdog = 3;

ModeSet modesOf(RobstrideControl control) {
  switch (control) {
    case RobstrideControl::kCurrent: return ModeSet{ControlMode::kCoast, ControlMode::kCurrent};
    case RobstrideControl::kVelocity:
      return ModeSet{ControlMode::kCoast, ControlMode::kVelocity, ControlMode::kBrake};
    case RobstrideControl::kPosition:
      return ModeSet{ControlMode::kCoast, ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kBrake};
    case RobstrideControl::kOperation: break;
  }
  return ModeSet{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                 ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kImpedance,
                 ControlMode::kBrake};
}

DriveFrames framesOf(RobstrideControl control) {
  const auto if_any = [](bool can) { return can ? Provision::kFrame : Provision::kUnsupported; };
  const bool operation = control == RobstrideControl::kOperation;
  const bool position = control == RobstrideControl::kPosition;
  return {.rest = Provision::kFrame,
          .poll = Provision::kFrame,
          .idle = Provision::kFrame,
          .damp = if_any(operation),
          .brake = if_any(control != RobstrideControl::kCurrent),
          .hold = if_any(operation || position),
          .enable = Provision::kFrame,
          .disable = Provision::kNothing,
          .brake_resists = operation};
}

class RobstrideFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "RobStride"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override {
    return robstrideModelNames();
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kRobstrideKeys; }

  [[nodiscard]] MotorTraits traits(std::string_view name, const OwnValues& own) const override {
    const auto& model = *findRobstrideModel(name);
    const auto control = robstrideControlOf(own);
    const double torque_nm_per_a = model.torqueNmPerA();
    MotorTraits traits;
    traits.min_id = 1;
    traits.max_id = 127;  // as its tool allows
    traits.gear_ratio = model.gear_ratio;
    traits.effort = CommandUnit::kAmpere;
    // In operation mode the torque scale ends before the current does; to a tenth, for people.
    const double full_scale_a = control == RobstrideControl::kOperation
                                    ? std::floor(10.0 * model.torque_range_nm / torque_nm_per_a) / 10.0
                                    : model.max_current_a;
    traits.effort_full_scale = static_cast<float>(full_scale_a);
    traits.torque_nm_per_a = static_cast<float>(torque_nm_per_a);
    traits.no_load_rpm = model.no_load_rpm;
    traits.reported_rpm = static_cast<float>(model.velocity_range_rad_s * kRpmPerRadPerS);
    traits.nominal_v = model.nominal_v;
    traits.phase_resistance_ohm = model.phase_resistance_ohm;
    traits.absolute = model.absolute;
    traits.frozen_a = static_cast<float>(model.torque_range_nm / torque_nm_per_a);
    traits.signed_a = traits.frozen_a;
    traits.limit_by_report = control == RobstrideControl::kVelocity || control == RobstrideControl::kPosition;
    traits.scaled_speed = true;
    traits.asked = true;
    // Half the scale passes in 250 ms at the highest speed; and a drive that was silent for that time may
    // have been without power.
    traits.restart_silence = std::chrono::milliseconds{200};
    traits.watchdog = own.integer("watchdog_ms") > 0;
    traits.modes = modesOf(control);
    if (control == RobstrideControl::kOperation)
      traits.spring_range = {model.stiffness_range_nm_per_rad, model.damping_range_nms_per_rad};
    traits.frames = framesOf(control);
    traits.setup = &robstrideSetup(model.cyber_gear);
    return traits;
  }

  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override {
    if (settings.own.integer("host_id") == settings.id) {
      return fail("host_id: " + std::to_string(settings.id) + " is the motor's own id");
    }
    const double range_rad = settings.own.number("position_range_rad");
    if (range_rad != 0.0 && range_rad < kShortestPositionRangeRad) {
      return fail("position_range_rad: it is 12.5 or 12.57, or 0 for the model's own");
    }
    const int watchdog_ms = settings.own.integer("watchdog_ms");
    const int commands_ms = kCommandsPerWatchdog * 1000 * settings.command_divider / settings.tick_hz;
    if (watchdog_ms > 0 && watchdog_ms <= commands_ms) {
      return fail("watchdog_ms: " + std::to_string(watchdog_ms) + " ms must be more than the " +
                  std::to_string(commands_ms) + " ms that three commands take");
    }
    return {};
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const int host_id = settings.own.integer("host_id");
    const auto drive_id = static_cast<std::uint32_t>(settings.id);
    const auto sends = [&](robstride::Type type) {
      return FrameFilter{.id = robstride::canId(type, drive_id, host_id), .mask = 0x1F00'FFFFU};
    };
    BusUse use;
    use.sends = {sends(robstride::Type::kFeedback), sends(robstride::Type::kReadParameter),
                 sends(robstride::Type::kFault), sends(robstride::Type::kReport),
                 FrameFilter{.id = robstride::canId(robstride::Type::kFault,
                                                    static_cast<std::uint32_t>(host_id), settings.id),
                             .mask = 0x1F00'FFFFU},
                 // Its announcement of itself.
                 FrameFilter{.id = robstride::canId(robstride::Type::kGetId, drive_id, 0xFE),
                             .mask = kExtendedIdMask}};
    // Whatever is addressed to it, of any type.
    use.obeys = {FrameFilter{.id = {drive_id, true}, .mask = 0xFFU}};
    for (const auto type :
         {robstride::Type::kOperate, robstride::Type::kEnable, robstride::Type::kStop,
          robstride::Type::kSetZero, robstride::Type::kSetId, robstride::Type::kWriteParameter})
      use.steers.push_back(
          {.id = {static_cast<std::uint32_t>(type) << 24U | drive_id, true}, .mask = 0x1F00'00FFU});
    const double commands_hz = static_cast<double>(settings.tick_hz) / settings.command_divider;
    const FrameShape shape{.extended = true, .length = 8};
    use.commands = {{.id = robstride::canId(robstride::Type::kOperate, 0x7FFF, settings.id),
                     .shape = shape,
                     .per_second = commands_hz},
                    {.id = robstride::canId(robstride::Type::kReadParameter,
                                            static_cast<std::uint32_t>(host_id), settings.id),
                     .shape = shape,
                     .per_second = 25.0}};
    use.feedback = {{.id = use.sends[0].id, .shape = shape, .per_second = commands_hz},
                    {.id = use.sends[1].id, .shape = shape, .per_second = 25.0}};
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    return registerSolo(std::make_unique<RobStride_Motor>(settings), parts);
  }
};

}  // namespace

const MotorFamily& robstrideFamily() noexcept {
  static const RobstrideFamily kFamily;
  return kFamily;
}

}  // namespace rc10
