#include "drives/cubemars/cubemars_family.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "app/units.hpp"
#include "drives/cubemars/cubemars_frames.hpp"
#include "drives/cubemars/cubemars_mit.hpp"
#include "drives/cubemars/cubemars_servo.hpp"

namespace rc10 {
namespace {

constexpr std::array<std::string_view, 3> kProtocols{"servo", "mit", "mit_v3"};
constexpr std::array<std::string_view, 3> kPositionBases{"output", "rotor", "electrical"};

using Kind = OwnKey::Kind;
constexpr std::array kCubemarsKeys{
    OwnKey{.name = "protocol",
           .kind = Kind::kChoice,
           .choices = kProtocols,
           .default_text = "servo",
           .about = "As set in the vendor's program: servo, mit (drives V1 and V2) or mit_v3"},
    OwnKey{.name = "pole_pairs",
           .kind = Kind::kInteger,
           .min = 0,
           .max = 64,
           .default_text = "0",
           .about = "Of the motor: half its number of magnets; 0: the model's own"},
    OwnKey{.name = "position_basis",
           .kind = Kind::kChoice,
           .choices = kPositionBases,
           .default_text = "output",
           .about = "servo and mit_v3: what the drive's degrees are of. Sources differ: turn the shaft "
                    "once by hand and see that total_angle_deg changes by 360."},
    OwnKey{
        .name = "output_encoder",
        .kind = Kind::kFlag,
        .default_text = "false",
        .about =
            "The drive has a second encoder at its output and knows its angle at power-up; zero_deg holds."},
    OwnKey{.name = "torque_constant_nm_per_a",
           .kind = Kind::kNumber,
           .unit = "Nm/A",
           .min = 0.0,
           .max = 10.0,
           .default_text = "0",
           .about = "Torque per ampere of the motor itself, before its gear (9.55 / KV); 0: the model's own"},
    OwnKey{.name = "brake_current_a",
           .kind = Kind::kNumber,
           .unit = "A",
           .min = 0.0,
           .max = 60.0,
           .default_text = "5",
           .about = "servo: how hard it brakes, within the current limit"},
    OwnKey{.name = "acceleration_limit_rpm_per_s",
           .kind = Kind::kNumber,
           .unit = "rpm/s",
           .min = 0.0,
           .max = 100000.0,
           .default_text = "0",
           .about = "servo: the drive plans its way to an angle with this; 0: it follows at once"},
    OwnKey{.name = "angle_stiffness_nm_per_rad",
           .kind = Kind::kNumber,
           .unit = "Nm/rad",
           .min = 0.0,
           .max = 500.0,
           .default_text = "30",
           .about = "mit: stiffness of angle targets and of hold, at the drive's own output."},
    OwnKey{.name = "angle_damping_nms_per_rad",
           .kind = Kind::kNumber,
           .unit = "Nms/rad",
           .min = 0.0,
           .max = 5.0,
           .default_text = "1",
           .about = "mit: damping of angle targets and of hold, at the drive's own output."},
    OwnKey{.name = "velocity_gain_nms_per_rad",
           .kind = Kind::kNumber,
           .unit = "Nms/rad",
           .min = 0.0,
           .max = 5.0,
           .above_min = true,
           .default_text = "2",
           .about = "mit: torque for each rad/s that a velocity target is missed by; also of the brake; "
                    "damp is a quarter of it."},
    OwnKey{.name = "velocity_range_rad_s",
           .kind = Kind::kNumber,
           .unit = "rad/s",
           .min = 0.0,
           .max = 200.0,
           .default_text = "0",
           .about = "mit: the velocity range set in the drive; 0: the model's"},
    OwnKey{.name = "torque_range_nm",
           .kind = Kind::kNumber,
           .unit = "Nm",
           .min = 0.0,
           .max = 500.0,
           .default_text = "0",
           .about = "mit: the torque range set in the drive; 0: the model's"}};

constexpr float kLargestServoA = 60.0F;  // of the current command, manual 5.1.2

constexpr DriveFrames kServoFrames{.rest = Provision::kFrame,
                                   .poll = Provision::kNothing,
                                   .idle = Provision::kFrame,
                                   .damp = Provision::kFrame,
                                   .brake = Provision::kFrame,
                                   .hold = Provision::kFrame,
                                   .brake_resists = true};
constexpr DriveFrames kMitFrames{.rest = Provision::kFrame,
                                 .poll = Provision::kFrame,
                                 .idle = Provision::kFrame,
                                 .damp = Provision::kFrame,
                                 .brake = Provision::kFrame,
                                 .hold = Provision::kFrame,
                                 .enable = Provision::kFrame,
                                 .brake_resists = true};
constexpr DriveFrames kMitV3Frames = kServoFrames;

constexpr ModeSet kServoModes{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                              ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kDuty,
                              ControlMode::kBrake};
constexpr ModeSet kServoLoops{ControlMode::kVelocity, ControlMode::kAngle, ControlMode::kTotalAngle,
                              ControlMode::kDuty};
constexpr ModeSet kMitModes{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                            ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kImpedance,
                            ControlMode::kBrake};

// Commands of the servo protocol are 0 to 8 in bits 8 and up; more is no command.
constexpr std::uint32_t kServoCommandMask = 0x1FFF'F0FFU;

/// Rate of commands, and of the answers of drives that only answer.
double commandsPerSecond(const MotorSettings& settings) {
  return static_cast<double>(settings.tick_hz) / std::max(settings.command_divider, 1);
}

class CubemarsFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "CubeMars"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override {
    return cubemarsModelNames();
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kCubemarsKeys; }
  [[nodiscard]] MotorTraits traits(std::string_view model, const OwnValues& own) const override {
    const auto settings = cubemarsSettings(model, own);
    auto traits = cubemarsTraits(settings);
    const bool brakes = settings.protocol != CubemarsProtocol::kServo || own.number("brake_current_a") > 0.0;
    if (!brakes) {
      traits.frames.brake = Provision::kUnsupported;
      traits.modes = traits.modes.without(ControlMode::kBrake);
    }
    return traits;
  }

  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override {
    const auto own = cubemarsSettings(settings.model, settings.own);
    const std::string model{own.model->name};
    if (own.protocol == CubemarsProtocol::kMitV3 && !own.model->v3) {
      return fail("protocol: the " + model + " is no V3 drive: write mit, or " + model + "-V3 as the model");
    }
    if (own.protocol == CubemarsProtocol::kMit && own.model->v3) {
      return fail("protocol: a V3 drive like the " + model + " does not understand mit: write mit_v3");
    }
    if (own.protocol == CubemarsProtocol::kMit && settings.own.text("position_basis") != "output") {
      return fail("position_basis: the protocol mit has positions of the output: leave the key out");
    }
    return {};
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const auto own = cubemarsSettings(settings.model, settings.own);
    const double told = commandsPerSecond(settings);
    BusUse use;
    if (own.protocol == CubemarsProtocol::kMit) {
      const PayloadDiscriminator sender{.value = static_cast<std::uint8_t>(settings.id)};
      const CanId id = cubemars::mitId(settings.id);
      use.sends = {{.id = {0, false}, .mask = kStandardIdMask, .discriminators = {sender}},
                   {.id = id, .mask = kStandardIdMask, .discriminators = {sender}}};
      use.obeys = {{.id = id, .mask = kStandardIdMask}};
      use.commands = {{.id = id, .shape = {.length = 8}, .per_second = told}};
      use.feedback = {{.id = {0, false}, .shape = {.length = 8}, .per_second = told}};
      return use;
    }
    const auto traits = cubemarsTraits(own);
    const bool servo = own.protocol == CubemarsProtocol::kServo;
    const int feedback_hz = settings.feedback_hz > 0 ? settings.feedback_hz : traits.feedback_hz;
    const CanId feedback_id = cubemars::servoFeedbackId(settings.id);
    const CanId command_id = cubemars::servoId(
        servo ? cubemars::ServoCommand::kPositionVelocity : cubemars::ServoCommand::kMit, settings.id);
    use.sends = {{.id = feedback_id}};
    use.obeys = {{.id = {static_cast<std::uint32_t>(settings.id), true}, .mask = kServoCommandMask}};
    // The longest of its commands.
    use.commands = {{.id = command_id, .shape = {.extended = true, .length = 8}, .per_second = told}};
    use.feedback = {{.id = feedback_id,
                     .shape = {.extended = true, .length = 8},
                     .per_second = static_cast<double>(feedback_hz)}};
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    const auto own = cubemarsSettings(settings.model, settings.own);
    if (own.protocol == CubemarsProtocol::kServo) {
      return registerSolo(std::make_unique<CubemarsServo>(settings, own), parts);
    }
    return registerSolo(std::make_unique<CubemarsMit>(settings, own), parts);
  }
};

}  // namespace

MotorTraits cubemarsTraits(const CubemarsSettings& own) {
  const CubemarsModel& model = *own.model;
  const bool mit = own.protocol == CubemarsProtocol::kMit;
  const bool servo = own.protocol == CubemarsProtocol::kServo;
  MotorTraits traits;
  traits.min_id = 1;
  traits.max_id = 254;  // 255 is everybody in the VESC firmware that the servo mode comes from
  traits.gear_ratio = model.gear_ratio;
  traits.effort = CommandUnit::kAmpere;
  // The end of the MIT torque range in amperes; what the motor can do in the other protocols as well.
  const auto full_nm = static_cast<float>(own.ranges.torque_nm);
  traits.effort_full_scale = std::min(full_nm / own.torque_nm_per_a, kLargestServoA);
  traits.torque_nm_per_a = own.torque_nm_per_a;
  traits.no_load_rpm = model.no_load_rpm;
  traits.reported_rpm = static_cast<float>(
      mit ? std::max(own.ranges.velocity_rad_s / kRadPerSPerRpm, cubemarsFastestRpm(model))
          : cubemars::kLargestReportedErpm / (model.gear_ratio * std::max(own.pole_pairs, 1)));
  traits.nominal_v = model.nominal_v;
  traits.phase_resistance_ohm = model.phase_resistance_ohm;
  traits.absolute = own.output_encoder;
  traits.reports_temperature = true;
  traits.frozen_a = mit || model.signed_current ? traits.effort_full_scale : 0.0F;
  traits.signed_a = traits.frozen_a;
  if (servo) traits.own_loops = kServoLoops;
  if (!(traits.signed_a > 0.0F))
    traits.unreported_current_remedy = traits.unreported_torque_remedy = "name another motor";
  if (servo) traits.unseen_limit_remedy = "set the drive to MIT and write protocol: mit (V3: mit_v3)";
  traits.feedback_hz = mit ? 1000 : 500;  // the upload rate is set in the vendor's program, 1 to 500 Hz
  traits.max_feedback_hz = mit ? 1000 : 500;
  traits.scaled_speed = mit;  // a V3 drive reports in the servo protocol's ERPM
  traits.asked = mit;
  // It has one (timeout_msec, 1000 in the settings of cubemars_hardware), but no frame reads or sets it.
  traits.watchdog = false;
  traits.modes = servo ? kServoModes : kMitModes;
  if (!servo) traits.spring_range = {CubemarsRanges::kStiffnessNmPerRad, CubemarsRanges::kDampingNmsPerRad};
  static constexpr DriveSetup kSetup{.tool = "CubeMars' upper computer (over its serial port)"};
  traits.setup = &kSetup;
  traits.frames = servo ? kServoFrames : (mit ? kMitFrames : kMitV3Frames);
  return traits;
}

const MotorFamily& cubemarsFamily() noexcept {
  static const CubemarsFamily kFamily;
  return kFamily;
}

}  // namespace rc10
