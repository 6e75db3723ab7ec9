#include "drives/vesc/vesc_family.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "app/units.hpp"
#include "drives/vesc/vesc_motor.hpp"

// Source, unless another is named: vedderb/bldc@b9d287b, its defaults in motor/mcconf_default.h and
// applications/appconf_default.h.
namespace rc10 {
namespace {

using Kind = OwnKey::Kind;

constexpr std::array<std::string_view, 1> kVescModels{"VESC"};
constexpr int kAsksPerSecond = 10;
// Packets 0 to 63 with its own id or 255: firmware compares the low byte, and all that it knows is below 64.
constexpr std::uint32_t kObeyedMask = 0x1FFF'C0FF;

constexpr std::array<std::string_view, 3> kAngles{"tachometer", "encoder", "none"};
constexpr std::array<std::string_view, 3> kStops{"regulate", "coast", "brake"};
constexpr std::array<std::string_view, 2> kTemperatures{"drive", "motor"};

constexpr std::array<OwnKey, 14> kVescKeys{
    OwnKey{.name = "pole_pairs",
           .kind = Kind::kInteger,
           .min = 1,
           .max = 100,
           .required = true,
           .about = "Of the motor: half its number of magnets"},
    OwnKey{.name = "angle",
           .kind = Kind::kChoice,
           .choices = kAngles,
           .default_text = "tachometer",
           .about = "What the angle comes from: tachometer (STATUS_5, angle loop on the host), encoder "
                    "(STATUS_4, the drive's own position loop) or none: no angle is reported."},
    OwnKey{.name = "position_divider",
           .kind = Kind::kNumber,
           .min = 0,
           .max = 1000,
           .above_min = true,
           .default_text = "1",
           .about = "With angle: encoder: Position Angle Division, as set in VESC Tool"},
    OwnKey{.name = "speed_ramp_erpm_per_s",
           .kind = Kind::kNumber,
           .unit = "ERPM/s",
           .min = 0,
           .max = 10'000'000,
           .above_min = true,
           .default_text = "25000",  // MCCONF_S_PID_RAMP_ERPMS_S
           .about = "With angle: tachometer: the ramp of the drive's speed loop, as set in VESC Tool"},
    OwnKey{
        .name = "velocity_zero",
        .kind = Kind::kChoice,
        .choices = kStops,
        .default_text = "regulate",
        .about =
            "What a velocity of 0 means: regulate (the drive's speed loop, which lets go below its minimum "
            "ERPM), coast or brake"},
    OwnKey{.name = "motor_current_max_a",
           .kind = Kind::kNumber,
           .unit = "A",
           .min = 0,
           .max = 2000,
           .above_min = true,
           .default_text = "60",  // MCCONF_L_CURRENT_MAX
           .about = "Motor Current Max, as set in VESC Tool: full scale of currents, the most that the "
                    "motor is told."},
    OwnKey{
        .name = "relative_current",
        .kind = Kind::kFlag,
        .default_text = "false",
        .about = "Send currents as a share of motor_current_max_a; the drive scales them by its own limits."},
    OwnKey{.name = "brake_current_a",
           .kind = Kind::kNumber,
           .unit = "A",
           .min = 0,
           .max = 2000,
           .default_text = "10",
           .about = "How hard it brakes, within the current limit"},
    OwnKey{.name = "handbrake_current_a",
           .kind = Kind::kNumber,
           .unit = "A",
           .min = 0,
           .max = 2000,
           .default_text = "0",
           .about = "With it a braked motor is held at standstill, by a current that flows all the time. "
                    "0: no handbrake."},
    OwnKey{.name = "kv_rpm_per_v",
           .kind = Kind::kNumber,
           .unit = "rpm/V",
           .min = 0,
           .max = 20000,
           .default_text = "0",
           .about = "KV of the motor, as printed on it: for torques, guards and damp. Torque per ampere "
                    "is 8.27 / KV (peak phase current, as VESC counts it). 0: unknown."},
    OwnKey{.name = "supply_v",
           .kind = Kind::kNumber,
           .unit = "V",
           .min = 0,
           .max = 200,
           .above_min = true,
           .default_text = "24",
           .about = "Voltage of the battery: with kv_rpm_per_v it gives the no-load speed."},
    OwnKey{.name = "temperature",
           .kind = Kind::kChoice,
           .choices = kTemperatures,
           .default_text = "drive",
           .about = "Which temperature is reported and watched: of the drive (its transistors), or of the "
                    "motor (only with a sensor)."},
    OwnKey{.name = "ask_status",
           .kind = Kind::kFlag,
           .default_text = "true",
           .about = "Ask the drive for its faults and its watchdog, 10 times a second. false: no faults "
                    "are seen, the watchdog is not looked at, there is no enable sequence."},
    OwnKey{.name = "host_id",
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
constexpr ModeSet kVescLoops{ControlMode::kVelocity, ControlMode::kAngle, ControlMode::kTotalAngle,
                             ControlMode::kDuty};

// Only the angle loop runs on the host: its output is a speed. 1.5 rpm/deg is a crossover of 9 rad/s, which
// leaves 75 degrees of phase for one sample of delay and the wait for the tick at 50 Hz.
constexpr CascadeConfig kAngleLoop{
    .velocity = PID_Position::Config{}, .angle = {.kp = 1.5F}, .velocity_limit_rpm = 0.0F};

// The q current of a VESC is the peak of the phase current.
static_assert(kTorqueTimesKv > 8.269 && kTorqueTimesKv < 8.271);

Provision holdOf(const VescSettings& own) {
  if (own.angle == VescAngle::kTachometer) return Provision::kHostLoop;
  if (own.angle == VescAngle::kEncoder) return Provision::kFrame;
  // The handbrake takes over at standstill: before, the brake has to stop the shaft.
  const bool stops = own.brake_current_a > 0.0F && own.handbrake_current_a > 0.0F;
  return stops ? Provision::kFrame : Provision::kUnsupported;
}

class VescFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "VESC"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override { return kVescModels; }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kVescKeys; }

  [[nodiscard]] MotorTraits traits(std::string_view /*model*/, const OwnValues& own) const override {
    return vescTraits(vescSettings(own));
  }

  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override {
    const VescSettings own = vescSettings(settings.own);
    if (own.host_id == settings.id) {
      return fail("host_id: " + std::to_string(own.host_id) + " is this drive's own id; give a free one");
    }
    if (own.velocity_zero == VescStop::kBrake && !(own.brake_current_a > 0.0F))
      return fail("velocity_zero: brake needs a brake_current_a above 0; or write velocity_zero: coast");
    if (own.angle != VescAngle::kTachometer) return {};
    if (own.handbrake_current_a > 0.0F) {
      return fail(
          "handbrake_current_a: not with angle: tachometer, which does not count while the handbrake "
          "holds; write angle: encoder or angle: none");
    }
    if (settings.feedback_hz > 0 && settings.feedback_hz < kVescLoopMinHz) {
      return fail("feedback_hz: angles from the tachometer need at least " + std::to_string(kVescLoopMinHz) +
                  " Hz; set the drive higher, or write angle: none");
    }
    return {};
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const VescSettings own = vescSettings(settings.own);
    const auto exactly = [&settings](vesc::Packet packet) {
      return FrameFilter{.id = vesc::canId(packet, settings.id)};
    };
    const FrameFilter answers{
        .id = vesc::canId(vesc::Packet::kProcessShortBuffer, own.host_id),
        .discriminators = {PayloadDiscriminator{.value = static_cast<std::uint8_t>(settings.id)}}};
    BusUse use;
    use.sends = {exactly(vesc::Packet::kStatus1),    exactly(vesc::Packet::kStatus2),
                 exactly(vesc::Packet::kStatus3),    exactly(vesc::Packet::kStatus4),
                 exactly(vesc::Packet::kStatus5),    exactly(vesc::Packet::kStatus6),
                 exactly(vesc::Packet::kNotifyBoot), answers};
    use.obeys = {
        FrameFilter{.id = {static_cast<std::uint32_t>(settings.id), true}, .mask = kObeyedMask},
        FrameFilter{.id = {static_cast<std::uint32_t>(vesc::kBroadcast), true}, .mask = kObeyedMask}};
    using vesc::Packet;
    for (const int id : {settings.id, vesc::kBroadcast}) {
      for (const auto packet : {Packet::kSetDuty,
                                Packet::kSetCurrent,
                                Packet::kSetCurrentBrake,
                                Packet::kSetErpm,
                                Packet::kSetPosition,
                                Packet::kSetCurrentRelative,
                                Packet::kSetCurrentBrakeRelative,
                                Packet::kSetHandbrake,
                                Packet::kSetHandbrakeRelative,
                                Packet::kDetect,
                                Packet::kShutdown,
                                Packet::kSetPositionOffset,
                                Packet::kSetCurrentLimits,
                                Packet::kStoreCurrentLimits,
                                Packet::kSetInputCurrentLimits,
                                Packet::kStoreInputCurrentLimits,
                                Packet::kSetFocErpms,
                                Packet::kStoreFocErpms,
                                Packet::kSetBatteryCut,
                                Packet::kStoreBatteryCut})
        use.steers.push_back({.id = vesc::canId(packet, id)});
      // A tool at another drive's USB passes its commands on: sender, a flag, then the command.
      for (const auto command : vesc::kPassedCommands)
        use.steers.push_back({.id = vesc::canId(Packet::kProcessShortBuffer, id),
                              .discriminators = {PayloadDiscriminator{.byte_index = 2, .value = command}}});
    }

    const double rate_hz = settings.feedback_hz > 0 ? settings.feedback_hz : 50.0;
    const auto status = [&](vesc::Packet packet, bool fast) {
      use.feedback.push_back({.id = vesc::canId(packet, settings.id),
                              .shape = {.extended = true, .length = vesc::kStatusLength},
                              .per_second = fast ? rate_hz : static_cast<double>(kVescSlowHz)});
    };
    status(vesc::Packet::kStatus1, true);
    status(vesc::Packet::kStatus4, own.angle == VescAngle::kEncoder);
    status(vesc::Packet::kStatus5, own.angle == VescAngle::kTachometer);
    use.commands.push_back(
        {.id = vesc::canId(vesc::Packet::kSetCurrent, settings.id),
         .shape = {.extended = true, .length = 4},
         .per_second = static_cast<double>(settings.tick_hz) / std::max(settings.command_divider, 1)});
    if (own.ask_status) {
      use.feedback.push_back(
          {.id = answers.id, .shape = {.extended = true, .length = 8}, .per_second = kAsksPerSecond});
      use.commands.push_back({.id = vesc::canId(vesc::Packet::kProcessShortBuffer, settings.id),
                              .shape = {.extended = true, .length = 7},
                              .per_second = kAsksPerSecond});
    }
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    if (auto checked = check(settings); !checked) return tl::unexpected(checked.error());
    return registerSolo(std::make_unique<VESC_Motor>(settings), parts);
  }
};

}  // namespace

MotorTraits vescTraits(const VescSettings& own) {
  MotorTraits traits;
  traits.min_id = 0;
  traits.max_id = 254;
  traits.gear_ratio = 1.0;
  traits.effort = CommandUnit::kAmpere;
  traits.effort_full_scale = own.motor_current_max_a;
  if (own.kv_rpm_per_v > 0.0) {
    traits.torque_nm_per_a = static_cast<float>(kTorqueTimesKv / own.kv_rpm_per_v);
    traits.no_load_rpm = static_cast<float>(own.kv_rpm_per_v * own.supply_v);
  } else {
    traits.unreported_torque_remedy = "write kv_rpm_per_v";
  }
  traits.nominal_v = static_cast<float>(own.supply_v);
  traits.absolute = own.angle == VescAngle::kEncoder && own.position_divider == 1.0;
  traits.feedback_hz = 50;  // APPCONF_CAN_STATUS_RATE_1
  traits.min_feedback_hz = own.angle == VescAngle::kTachometer ? kVescLoopMinHz : 1;
  traits.max_feedback_hz = 1000;  // the setting goes higher, the bus does not
  // Its own limits may keep the current below what it is told: that is no frozen reading.
  traits.frozen_a = 0.0F;
  traits.signed_a = own.motor_current_max_a;
  traits.own_limit_key = "motor_current_max_a";
  traits.limit_by_report = true;
  traits.asked = false;
  traits.unseen_start = std::chrono::milliseconds{300};  // before 6.00; no source: cautious
  traits.watchdog = own.ask_status;
  traits.reports_angle = own.angle != VescAngle::kNone;
  traits.modes = own.angle == VescAngle::kNone ? kVescModes : kVescModesWithAngle;
  if (!(own.brake_current_a > 0.0F)) traits.modes = traits.modes.without(ControlMode::kBrake);
  traits.own_loops = traits.modes & kVescLoops;
  static constexpr DriveSetup kSetup{.tool = "VESC Tool (the simple CAN commands write no settings)"};
  traits.setup = &kSetup;
  traits.frames = {.rest = Provision::kFrame,
                   .poll = Provision::kNothing,
                   .idle = Provision::kFrame,
                   // The share of the current limit that the speed has of the no-load speed.
                   .damp = own.kv_rpm_per_v > 0.0 ? Provision::kHostLoop : Provision::kUnsupported,
                   .brake = own.brake_current_a > 0.0F ? Provision::kFrame : Provision::kUnsupported,
                   .hold = holdOf(own),
                   .enable = own.ask_status ? Provision::kFrame : Provision::kNothing,
                   .disable = Provision::kNothing,
                   .brake_resists = true};
  traits.host_loops = own.angle == VescAngle::kTachometer ? &kAngleLoop : nullptr;
  traits.own_velocity_loop = true;
  return traits;
}

const MotorFamily& vescFamily() noexcept {
  static const VescFamily kFamily;
  return kFamily;
}

}  // namespace rc10
