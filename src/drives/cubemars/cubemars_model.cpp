#include "drives/cubemars/cubemars_model.hpp"

#include <algorithm>
#include <string>

// Sources. Ranges: CubeMars AK series module driver manual V1.0.8 (MIT table), which TMotorCANControl,
// KMR_CubeMars and cubemars_driver_node repeat; V3: cubemars_driver_node and epicallypowerful. Pole pairs:
// TMotorCANControl, epicallypowerful, cubemars_servo_can; for AK70-10 also foc_encoder_ratio 21 in the
// drive's exported settings (cubemars_hardware, .params). Gear: the number in the name (TMotorCANControl has
// 80 for AK80-64). Torque constants: the vendor's, 60 / (2 pi KV). No-load speed: KV * nominal voltage /
// gear, derived. Where a shop sells other windings under the name, torque_constant_nm_per_a says so.
namespace rc10 {
namespace {

constexpr CubeMarsRanges range(double position_rad, double velocity_rad_s, double torque_nm) {
  return {.position_rad = position_rad, .velocity_rad_s = velocity_rad_s, .torque_nm = torque_nm};
}

constexpr std::array kCubeMarsModels{
    CubeMarsModel{.name = "AK10-9",
                  .gear_ratio = 9.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.16F,
                  .no_load_rpm = 320.0F,  // KV 60
                  .ranges = range(12.5, 50.0, 65.0)},
    CubeMarsModel{.name = "AK60-6",
                  .gear_ratio = 6.0,
                  .pole_pairs = 14,
                  .rotor_torque_nm_per_a = 0.068F,
                  .nominal_v = 24.0F,
                  .no_load_rpm = 560.0F,               // KV 140
                  .ranges = range(12.5, 50.0, 15.0)},  // KMR_CubeMars: 45 rad/s, see velocity_range_rad_s
    CubeMarsModel{.name = "AK70-10",
                  .gear_ratio = 10.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.095F,
                  .no_load_rpm = 480.0F,            // KV 100
                  .phase_resistance_ohm = 0.0933F,  // foc_motor_r of an exported setting
                  .ranges = range(12.5, 50.0, 25.0)},
    CubeMarsModel{.name = "AK80-6",
                  .gear_ratio = 6.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.091F,
                  .no_load_rpm = 800.0F,  // KV 100
                  // Firmware V1.1 has 22.5 rad/s (measured by others): velocity_range_rad_s.
                  .ranges = range(12.5, 76.0, 12.0)},
    CubeMarsModel{.name = "AK80-8",
                  .gear_ratio = 8.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.159F,
                  .no_load_rpm = 360.0F,  // KV 60
                  .ranges = range(12.5, 37.5, 32.0)},
    CubeMarsModel{.name = "AK80-9",
                  .gear_ratio = 9.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.091F,  // TMotorCANControl measured 0.115
                  .no_load_rpm = 533.0F,            // KV 100
                  .ranges = range(12.5, 50.0, 18.0)},
    CubeMarsModel{.name = "AK80-64",
                  .gear_ratio = 64.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.119F,
                  .no_load_rpm = 60.0F,  // KV 80
                  .ranges = range(12.5, 8.0, 144.0)},
    CubeMarsModel{.name = "AK10-9-V3",
                  .gear_ratio = 9.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 1.1314F / 9.0F,  // measured: cubemars_driver_node
                  .no_load_rpm = 320.0F,
                  .v3 = true,
                  .signed_current = false,  // cubemars_driver_node
                  .ranges = range(12.56, 28.0, 54.0)},
    CubeMarsModel{.name = "AK60-6-V3",
                  .gear_ratio = 6.0,
                  .pole_pairs = 14,
                  .rotor_torque_nm_per_a = 0.119F,  // KV 80 (cubemars_servo_can)
                  .no_load_rpm = 640.0F,
                  .v3 = true,
                  .ranges = range(12.56, 60.0, 12.0)},
    CubeMarsModel{.name = "AK80-8-V3",
                  .gear_ratio = 8.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 1.0566F / 8.0F,  // measured: cubemars_driver_node
                  .no_load_rpm = 360.0F,
                  .v3 = true,
                  .ranges = range(12.5, 37.5, 32.0)},
    CubeMarsModel{.name = "AK80-9-V3",
                  .gear_ratio = 9.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.095F,  // cubemars_servo_can
                  .no_load_rpm = 533.0F,
                  .v3 = true,
                  .ranges = range(12.56, 65.0, 18.0)}};

constexpr std::array<std::string_view, 3> kProtocols{"servo", "mit", "mit_v3"};
constexpr std::array<std::string_view, 3> kPositionBases{"output", "rotor", "electrical"};

using Kind = FamilyKey::Kind;
constexpr std::array kCubeMarsKeys{
    FamilyKey{.name = "protocol",
              .kind = Kind::kChoice,
              .choices = kProtocols,
              .default_text = "servo",
              .about = "As set in the vendor's program: servo, mit (drives V1 and V2) or mit_v3"},
    FamilyKey{.name = "pole_pairs",
              .kind = Kind::kInteger,
              .min = 0,
              .max = 64,
              .default_text = "0",
              .about = "Of the motor: half its number of magnets; 0: the model's own"},
    FamilyKey{.name = "position_basis",
              .kind = Kind::kChoice,
              .choices = kPositionBases,
              .default_text = "output",
              .about = "servo and mit_v3: what the drive's degrees are of. Sources differ: turn the shaft "
                       "once by hand and see that total_angle_deg changes by 360."},
    FamilyKey{
        .name = "output_encoder",
        .kind = Kind::kFlag,
        .default_text = "false",
        .about =
            "The drive has a second encoder at its output and knows its angle at power-up; zero_deg holds."},
    FamilyKey{
        .name = "torque_constant_nm_per_a",
        .kind = Kind::kNumber,
        .unit = "Nm/A",
        .min = 0.0,
        .max = 10.0,
        .default_text = "0",
        .about = "Torque per ampere of the motor itself, before its gear (9.55 / KV); 0: the model's own"},
    FamilyKey{.name = "brake_current_a",
              .kind = Kind::kNumber,
              .unit = "A",
              .min = 0.0,
              .max = 60.0,
              .default_text = "5",
              .about = "servo: how hard it brakes, within the current limit"},
    FamilyKey{.name = "acceleration_limit_rpm_per_s",
              .kind = Kind::kNumber,
              .unit = "rpm/s",
              .min = 0.0,
              .max = 100000.0,
              .default_text = "0",
              .about = "servo: the drive plans its way to an angle with this; 0: it follows at once"},
    FamilyKey{.name = "angle_stiffness_nm_per_rad",
              .kind = Kind::kNumber,
              .unit = "Nm/rad",
              .min = 0.0,
              .max = 500.0,
              .default_text = "30",
              .about = "mit: stiffness of angle targets and of hold, at the drive's own output."},
    FamilyKey{.name = "angle_damping_nms_per_rad",
              .kind = Kind::kNumber,
              .unit = "Nms/rad",
              .min = 0.0,
              .max = 5.0,
              .default_text = "1",
              .about = "mit: damping of angle targets and of hold, at the drive's own output."},
    FamilyKey{.name = "velocity_gain_nms_per_rad",
              .kind = Kind::kNumber,
              .unit = "Nms/rad",
              .min = 0.0,
              .max = 5.0,
              .above_min = true,
              .default_text = "2",
              .about = "mit: torque for each rad/s that a velocity target is missed by; also of the brake; "
                       "damp is a quarter of it."},
    FamilyKey{.name = "velocity_range_rad_s",
              .kind = Kind::kNumber,
              .unit = "rad/s",
              .min = 0.0,
              .max = 200.0,
              .default_text = "0",
              .about = "mit: the velocity range set in the drive; 0: the model's"},
    FamilyKey{.name = "torque_range_nm",
              .kind = Kind::kNumber,
              .unit = "Nm",
              .min = 0.0,
              .max = 500.0,
              .default_text = "0",
              .about = "mit: the torque range set in the drive; 0: the model's"}};

// 6 and 7: the newer manuals and cubemars_driver_node. Older ones call 6 "phase unbalance" and have no 7.
constexpr std::array kCubeMarsFaults{
    CubeMarsFault{1, FaultCode::kDriveMotorTooHot, "motor too hot"},
    CubeMarsFault{2, FaultCode::kDriveOverCurrent, "over-current"},
    CubeMarsFault{3, FaultCode::kDriveOverVoltage, "over-voltage"},
    CubeMarsFault{4, FaultCode::kDriveUnderVoltage, "under-voltage"},
    CubeMarsFault{5, FaultCode::kDriveEncoder, "encoder"},
    CubeMarsFault{6, FaultCode::kDriveTooHot, "power stage too hot (older firmware: phase unbalance)"},
    CubeMarsFault{7, FaultCode::kDriveStalled, "motor stalled"}};

constexpr float kLargestServoA = 60.0F;  // of the current command, manual 5.1.2

constexpr DriveFrames kServoFrames{.rest = Provision::kFrame,
                                   .poll = Provision::kNothing,
                                   .idle = Provision::kFrame,
                                   .damp = Provision::kFrame,
                                   .brake = Provision::kFrame,
                                   .hold = Provision::kFrame};
constexpr DriveFrames kMitFrames{.rest = Provision::kFrame,
                                 .poll = Provision::kFrame,
                                 .idle = Provision::kFrame,
                                 .damp = Provision::kFrame,
                                 .brake = Provision::kFrame,
                                 .hold = Provision::kFrame,
                                 .enable = Provision::kFrame};
constexpr DriveFrames kMitV3Frames = kServoFrames;

constexpr ModeSet kServoModes{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                              ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kDuty,
                              ControlMode::kBrake};
constexpr ModeSet kMitModes{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                            ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kImpedance,
                            ControlMode::kBrake};

double messageDegPerDeg(const CubeMarsModel& model, int pole_pairs, std::string_view basis) noexcept {
  if (basis == "rotor") return model.gear_ratio;
  if (basis == "electrical") return model.gear_ratio * std::max(pole_pairs, 1);
  return 1.0;
}

}  // namespace

std::span<const CubeMarsModel> cubemarsModels() noexcept { return kCubeMarsModels; }

const CubeMarsModel* findCubemarsModel(std::string_view name) noexcept {
  const auto found = std::find_if(kCubeMarsModels.begin(), kCubeMarsModels.end(),
                                  [name](const auto& model) { return model.name == name; });
  return found == kCubeMarsModels.end() ? nullptr : &*found;
}

CubeMarsSetup cubemarsSetup(std::string_view model_name, const OwnValues& own) {
  const CubeMarsModel* found = findCubemarsModel(model_name);
  const CubeMarsModel& model = found == nullptr ? kCubeMarsModels.front() : *found;
  CubeMarsSetup setup{.model = &model, .ranges = model.ranges};
  const std::string protocol = own.text("protocol");
  if (protocol == "mit") setup.protocol = CubeMarsProtocol::kMit;
  if (protocol == "mit_v3") setup.protocol = CubeMarsProtocol::kMitV3;
  setup.pole_pairs = own.integer("pole_pairs") > 0 ? own.integer("pole_pairs") : model.pole_pairs;
  const auto torque_constant = static_cast<float>(own.number("torque_constant_nm_per_a"));
  setup.torque_nm_per_a = (torque_constant > 0.0F ? torque_constant : model.rotor_torque_nm_per_a) *
                          static_cast<float>(model.gear_ratio);
  if (const double range = own.number("velocity_range_rad_s"); range > 0.0)
    setup.ranges.velocity_rad_s = range;
  if (const double range = own.number("torque_range_nm"); range > 0.0) setup.ranges.torque_nm = range;
  setup.message_deg_per_deg = messageDegPerDeg(model, setup.pole_pairs, own.text("position_basis"));
  setup.output_encoder = own.flag("output_encoder");
  return setup;
}

MotorTraits cubemarsTraits(const CubeMarsSetup& setup) {
  const CubeMarsModel& model = *setup.model;
  const bool mit = setup.protocol == CubeMarsProtocol::kMit;
  const bool servo = setup.protocol == CubeMarsProtocol::kServo;
  MotorTraits traits;
  traits.min_id = 1;
  traits.max_id = 254;  // 255 is everybody in the VESC firmware that the servo mode comes from
  traits.gear_ratio = model.gear_ratio;
  traits.effort = CommandUnit::kAmpere;
  // The end of the MIT torque range in amperes; what the motor can do in the other protocols as well.
  const auto full_nm = static_cast<float>(setup.ranges.torque_nm);
  traits.effort_full_scale = std::min(full_nm / setup.torque_nm_per_a, kLargestServoA);
  traits.torque_nm_per_a = setup.torque_nm_per_a;
  traits.no_load_rpm = model.no_load_rpm;
  traits.nominal_v = model.nominal_v;
  traits.phase_resistance_ohm = model.phase_resistance_ohm;
  traits.absolute = setup.output_encoder;
  traits.reports_temperature = true;
  traits.frozen_a = mit || model.signed_current ? traits.effort_full_scale : 0.0F;
  traits.feedback_hz = mit ? 1000 : 500;  // the upload rate is set in the vendor's program, 1 to 500 Hz
  traits.max_feedback_hz = mit ? 1000 : 500;
  traits.asked = mit;
  // It has one (timeout_msec, 1000 in the settings of cubemars_hardware), but no frame reads or sets it.
  traits.watchdog = false;
  traits.modes = servo ? kServoModes : kMitModes;
  static constexpr DriveSetup kSetup{.tool = "CubeMars' upper computer (over its serial port)"};
  traits.setup = &kSetup;
  traits.frames = servo ? kServoFrames : (mit ? kMitFrames : kMitV3Frames);
  return traits;
}

std::span<const FamilyKey> cubemarsKeys() noexcept { return kCubeMarsKeys; }

std::span<const CubeMarsFault> cubemarsFaults() noexcept { return kCubeMarsFaults; }

FaultCode cubemarsFault(std::uint8_t code) noexcept {
  if (code == 0) return FaultCode::kNone;
  for (const auto& known : kCubeMarsFaults) {
    if (known.code == code) return known.fault;
  }
  return FaultCode::kDriveOther;
}

}  // namespace rc10
