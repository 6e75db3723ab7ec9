#include "drives/vesc/vesc_model.hpp"

#include <numbers>

// Source, unless another is named: vedderb/bldc@b9d287b, its defaults in motor/mcconf_default.h and
// applications/appconf_default.h.
namespace rc10 {
namespace {

using Kind = FamilyKey::Kind;

constexpr std::array<std::string_view, 3> kAngles{"tachometer", "encoder", "none"};
constexpr std::array<std::string_view, 3> kStops{"regulate", "coast", "brake"};
constexpr std::array<std::string_view, 2> kTemperatures{"drive", "motor"};

constexpr std::array<FamilyKey, 14> kVescKeys{
    FamilyKey{.name = "pole_pairs",
              .kind = Kind::kInteger,
              .min = 1,
              .max = 100,
              .required = true,
              .about = "Of the motor: half its number of magnets"},
    FamilyKey{.name = "angle",
              .kind = Kind::kChoice,
              .choices = kAngles,
              .default_text = "tachometer",
              .about = "What the angle comes from: tachometer (STATUS_5, angle loop on the host), encoder "
                       "(STATUS_4, the drive's own position loop) or none: no angle is reported."},
    FamilyKey{.name = "position_divider",
              .kind = Kind::kNumber,
              .min = 0,
              .max = 1000,
              .above_min = true,
              .default_text = "1",
              .about = "With angle: encoder: Position Angle Division, as set in VESC Tool"},
    FamilyKey{.name = "speed_ramp_erpm_per_s",
              .kind = Kind::kNumber,
              .unit = "ERPM/s",
              .min = 0,
              .max = 10'000'000,
              .above_min = true,
              .default_text = "25000",  // MCCONF_S_PID_RAMP_ERPMS_S
              .about = "With angle: tachometer: the ramp of the drive's speed loop, as set in VESC Tool"},
    FamilyKey{
        .name = "velocity_zero",
        .kind = Kind::kChoice,
        .choices = kStops,
        .default_text = "regulate",
        .about =
            "What a velocity of 0 means: regulate (the drive's speed loop, which lets go below its minimum "
            "ERPM), coast or brake"},
    FamilyKey{.name = "motor_current_max_a",
              .kind = Kind::kNumber,
              .unit = "A",
              .min = 0,
              .max = 2000,
              .above_min = true,
              .default_text = "60",  // MCCONF_L_CURRENT_MAX
              .about = "Motor Current Max, as set in VESC Tool: full scale of currents, the most that the "
                       "motor is told."},
    FamilyKey{
        .name = "relative_current",
        .kind = Kind::kFlag,
        .default_text = "false",
        .about = "Send currents as a share of motor_current_max_a; the drive scales them by its own limits."},
    FamilyKey{.name = "brake_current_a",
              .kind = Kind::kNumber,
              .unit = "A",
              .min = 0,
              .max = 2000,
              .default_text = "10",
              .about = "How hard it brakes, within the current limit"},
    FamilyKey{.name = "handbrake_current_a",
              .kind = Kind::kNumber,
              .unit = "A",
              .min = 0,
              .max = 2000,
              .default_text = "0",
              .about = "With it a braked motor is held at standstill, by a current that flows all the time. "
                       "0: no handbrake."},
    FamilyKey{.name = "kv_rpm_per_v",
              .kind = Kind::kNumber,
              .unit = "rpm/V",
              .min = 0,
              .max = 20000,
              .default_text = "0",
              .about = "KV of the motor, as printed on it: for torques, guards and damp. Torque per ampere "
                       "is 8.27 / KV (peak phase current, as VESC counts it). 0: unknown."},
    FamilyKey{.name = "supply_v",
              .kind = Kind::kNumber,
              .unit = "V",
              .min = 0,
              .max = 200,
              .above_min = true,
              .default_text = "24",
              .about = "Of the battery: with kv_rpm_per_v it gives the no-load speed."},
    FamilyKey{.name = "temperature",
              .kind = Kind::kChoice,
              .choices = kTemperatures,
              .default_text = "drive",
              .about = "Which temperature is reported and watched: of the drive (its transistors), or of the "
                       "motor (only with a sensor)."},
    FamilyKey{.name = "ask_status",
              .kind = Kind::kFlag,
              .default_text = "true",
              .about = "Ask the drive for its faults and its watchdog, 10 times a second. false: no faults "
                       "are seen, the watchdog is not looked at, there is no enable sequence."},
    FamilyKey{.name = "host_id",
              .kind = Kind::kInteger,
              .min = 0,
              .max = 254,
              .default_text = "253",
              .about = "The controller id of rc10d itself, for the answers; no drive may have it."},
};

constexpr ModeSet kVescModes{ControlMode::kCoast, ControlMode::kCurrent, ControlMode::kVelocity,
                             ControlMode::kDuty, ControlMode::kBrake};
constexpr ModeSet kVescModesWithAngle{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                                      ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kDuty,
                                      ControlMode::kBrake};

// Only the angle loop runs on the host: its output is a speed. 1.5 rpm/deg is a crossover of 9 rad/s, which
// leaves 75 degrees of phase for one sample of delay and the wait for the tick at 50 Hz.
constexpr CascadeConfig kAngleLoop{
    .velocity = PID_Position::Config{.kp = 0.1F}, .angle = {.kp = 1.5F}, .velocity_limit_rpm = 0.0F};

// The q current of a VESC is the peak of the phase current: Kt = 1.5 * pole pairs * flux linkage, and KV (of
// the peak between two phases) = 60 / (sqrt(3) * 2 pi * pole pairs * flux linkage).
constexpr double kTorqueTimesKv = 1.5 * 60.0 / (std::numbers::sqrt3 * 2.0 * std::numbers::pi);
static_assert(kTorqueTimesKv > 8.269 && kTorqueTimesKv < 8.271);

// By native code: mc_fault_code.
constexpr auto kVescFaults = [] {
  using enum FaultCode;
  return std::array<FaultCode, 34>{
      kNone,
      kDriveOverVoltage,
      kDriveUnderVoltage,
      kDriveHardware,     // DRV: the gate driver
      kDriveOverCurrent,  // absolute maximum
      kDriveTooHot,
      kDriveMotorTooHot,
      kDriveHardware,  // gate driver over-voltage
      kDriveHardware,  // gate driver under-voltage
      kDriveHardware,  // MCU under-voltage
      kDriveHardware,  // booting from a reset by the processor's watchdog
      kDriveEncoder,   // SPI
      kDriveEncoder,   // sin/cos too weak
      kDriveEncoder,   // sin/cos too strong
      kDriveHardware,  // flash
      kDriveHardware,  // offset of current sensor 1
      kDriveHardware,
      kDriveHardware,
      kDrivePhase,     // unbalanced currents
      kDriveHardware,  // BRK
      kDriveEncoder,   // resolver LOT
      kDriveEncoder,   // resolver DOS
      kDriveEncoder,   // resolver LOS
      kDriveSetting,   // flash, application settings
      kDriveSetting,   // flash, motor settings
      kDriveEncoder,   // no magnet
      kDriveEncoder,   // magnet too strong
      kDrivePhase,     // phase filter
      kDriveEncoder,   // encoder
      kDriveHardware,  // low-voltage output
      kDriveEncoder,   // encoder slipped
      kDriveLimit,     // too fast
      kDriveLimit,     // too slow
      kDriveLimit,     // too fast, absolute
  };
}();

VescAngle angleOf(const std::string& text) {
  if (text == "encoder") return VescAngle::kEncoder;
  return text == "none" ? VescAngle::kNone : VescAngle::kTachometer;
}

VescStop stopOf(const std::string& text) {
  if (text == "coast") return VescStop::kCoast;
  return text == "brake" ? VescStop::kBrake : VescStop::kRegulate;
}

Provision holdOf(const VescOptions& options) {
  if (options.angle == VescAngle::kTachometer) return Provision::kHostLoop;
  if (options.angle == VescAngle::kEncoder) return Provision::kFrame;
  return options.handbrake_current_a > 0.0F ? Provision::kFrame : Provision::kUnsupported;
}

}  // namespace

VescOptions::VescOptions(const OwnValues& own)
    : pole_pairs(own.integer("pole_pairs")),
      angle(angleOf(own.text("angle"))),
      position_divider(own.number("position_divider")),
      speed_ramp_erpm_per_s(own.number("speed_ramp_erpm_per_s")),
      velocity_zero(stopOf(own.text("velocity_zero"))),
      motor_current_max_a(static_cast<float>(own.number("motor_current_max_a"))),
      relative_current(own.flag("relative_current")),
      brake_current_a(static_cast<float>(own.number("brake_current_a"))),
      handbrake_current_a(static_cast<float>(own.number("handbrake_current_a"))),
      kv_rpm_per_v(own.number("kv_rpm_per_v")),
      supply_v(own.number("supply_v")),
      motor_temperature(own.text("temperature") == "motor"),
      ask_status(own.flag("ask_status")),
      host_id(own.integer("host_id")) {}

std::span<const FamilyKey> vescKeys() noexcept { return kVescKeys; }

MotorTraits vescTraits(const VescOptions& options) {
  MotorTraits traits;
  traits.min_id = 0;
  traits.max_id = 254;
  traits.gear_ratio = 1.0;
  traits.effort = CommandUnit::kAmpere;
  traits.effort_full_scale = options.motor_current_max_a;
  if (options.kv_rpm_per_v > 0.0) {
    traits.torque_nm_per_a = static_cast<float>(kTorqueTimesKv / options.kv_rpm_per_v);
    traits.no_load_rpm = static_cast<float>(options.kv_rpm_per_v * options.supply_v);
  }
  traits.nominal_v = static_cast<float>(options.supply_v);
  traits.absolute = options.angle == VescAngle::kEncoder && options.position_divider == 1.0;
  traits.feedback_hz = 50;  // APPCONF_CAN_STATUS_RATE_1
  traits.min_feedback_hz = options.angle == VescAngle::kTachometer ? kVescLoopMinHz : 1;
  traits.max_feedback_hz = 1000;  // the setting goes higher, the bus does not
  // Its own limits may keep the current below what it is told: that is no frozen reading.
  traits.frozen_a = 0.0F;
  traits.asked = false;
  traits.watchdog = options.ask_status;
  traits.modes = options.angle == VescAngle::kNone ? kVescModes : kVescModesWithAngle;
  static constexpr DriveSetup kSetup{.tool = "VESC Tool (the simple CAN commands write no settings)"};
  traits.setup = &kSetup;
  traits.frames = {.rest = Provision::kFrame,
                   .poll = Provision::kNothing,
                   .idle = Provision::kFrame,
                   // The share of the current limit that the speed has of the no-load speed.
                   .damp = options.kv_rpm_per_v > 0.0 ? Provision::kHostLoop : Provision::kUnsupported,
                   .brake = Provision::kFrame,
                   .hold = holdOf(options),
                   .enable = options.ask_status ? Provision::kFrame : Provision::kNothing,
                   .disable = Provision::kNothing};
  traits.host_loops = options.angle == VescAngle::kTachometer ? &kAngleLoop : nullptr;
  traits.own_velocity_loop = true;
  return traits;
}

FaultCode vescFault(std::uint8_t native_code) noexcept {
  return native_code < kVescFaults.size() ? kVescFaults[native_code] : FaultCode::kDriveOther;
}

}  // namespace rc10
