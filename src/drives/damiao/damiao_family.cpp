#include "drives/damiao/damiao_family.hpp"

#include <cmath>
#include <memory>
#include <string>

#include "app/units.hpp"
#include "drives/damiao/damiao_motor.hpp"

namespace rc10 {
namespace {

using damiao::kKdMax;
using damiao::kKpMax;

constexpr double kLongestWatchdogMs = 10'000.0;

constexpr std::array kDamiaoKeys{
    OwnKey{
        .name = "master_id",
        .kind = OwnKey::Kind::kInteger,
        .min = 0,
        .max = 2047,
        .required = true,
        .about = "The id on which the drive answers, as set on it (Master ID); by custom its own id + 16."},
    OwnKey{.name = "control",
           .kind = OwnKey::Kind::kChoice,
           .choices = kDamiaoControlNames,
           .default_text = "mit",
           .about = "The drive's control mode, set when it is enabled. Decides which modes the motor has."},
    OwnKey{.name = "watchdog_ms",
           .kind = OwnKey::Kind::kInteger,
           .unit = "ms",
           .min = 5,
           .max = kLongestWatchdogMs,
           .default_text = "100",
           .about = "The drive's own watchdog: it lets go by itself after so long without a command. At "
                    "least three commands long; set when it is enabled."},
    OwnKey{.name = "p_max_rad",
           .unit = "rad",
           .max = 1000,
           .above_min = true,
           .about = "PMAX as set on the drive, if otherwise than the model's own. Default: the model's own."},
    OwnKey{.name = "v_max_rad_s",
           .unit = "rad/s",
           .max = 1000,
           .above_min = true,
           .about = "VMAX as set on the drive, if otherwise than the model's own. Default: the model's own."},
    OwnKey{.name = "t_max_nm",
           .unit = "Nm",
           .max = 1000,
           .above_min = true,
           .about = "TMAX as set on the drive, if otherwise than the model's own. Default: the model's own."},
    OwnKey{.name = "velocity_damping_nms_per_rad",
           .unit = "Nms/rad",
           .max = 100'000,
           .above_min = true,
           .about = "Control mit: torque per difference of speed in modes velocity and brake. DM4310: 1. "
                    "Default: the model's own."},
    OwnKey{.name = "angle_stiffness_nm_per_rad",
           .unit = "Nm/rad",
           .max = 10'000'000,
           .above_min = true,
           .about = "Control mit: torque per difference of angle in modes angle, total_angle and the "
                    "fallback hold. DM4310: 20. Default: the model's own."},
    OwnKey{
        .name = "angle_damping_nms_per_rad",
        .unit = "Nms/rad",
        .max = 100'000,
        .above_min = true,
        .about =
            "Control mit: torque against the speed in the same modes. DM4310: 1. Default: the model's own."},
    OwnKey{.name = "can_fd",
           .kind = OwnKey::Kind::kFlag,
           .default_text = "false",
           .about = "CAN FD frames with bit rate switch: the drive's baud rate is above 1 Mbit/s, and it "
                    "answers in such frames only."},
};

constexpr DriveFrames driveFrames(DamiaoControl control) {
  DriveFrames frames{.rest = Provision::kFrame,
                     .poll = Provision::kFrame,
                     .idle = Provision::kFrame,
                     .brake = Provision::kFrame,
                     .enable = Provision::kFrame};
  const bool mit = control == DamiaoControl::kMit;
  if (mit) frames.damp = Provision::kFrame;
  frames.brake_resists = mit;  // a spring law without stiffness
  frames.idle_rests = mit;     // the other modes hold a standstill
  // At a speed of 0 a drive in velocity mode may be pulled away for good.
  if (control != DamiaoControl::kVelocity) frames.hold = Provision::kFrame;
  return frames;
}

/// Its frames carry a limit of the current, or a torque.
constexpr bool boundsCurrent(DamiaoControl control) {
  return control == DamiaoControl::kMit || control == DamiaoControl::kForcePosition;
}

constexpr ModeSet modes(DamiaoControl control) {
  switch (control) {
    case DamiaoControl::kMit:
      return ModeSet{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                     ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kImpedance,
                     ControlMode::kBrake};
    case DamiaoControl::kVelocity:
      return ModeSet{ControlMode::kCoast, ControlMode::kVelocity, ControlMode::kBrake};
    case DamiaoControl::kPositionVelocity:
    case DamiaoControl::kForcePosition: break;
  }
  return ModeSet{ControlMode::kCoast, ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kBrake};
}

class DamiaoFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "Damiao"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override {
    return damiaoModelNames();
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kDamiaoKeys; }
  [[nodiscard]] MotorTraits traits(std::string_view name, const OwnValues& own) const override;
  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override;
  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override;
  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    return registerSolo(std::make_unique<Damiao_Motor>(settings), parts);
  }
};

double given(const OwnValues& own, std::string_view key, double otherwise) {
  const double value = own.number(key);
  return value > 0.0 ? value : otherwise;
}

DamiaoScale scaleOf(const DamiaoModel& model, const OwnValues& own) {
  return {given(own, "p_max_rad", model.scale.p_max_rad), given(own, "v_max_rad_s", model.scale.v_max_rad_s),
          given(own, "t_max_nm", model.scale.t_max_nm)};
}

MotorTraits DamiaoFamily::traits(std::string_view name, const OwnValues& own) const {
  const auto* found = findDamiaoModel(name);
  const DamiaoModel& model = found != nullptr ? *found : damiaoModels().front();
  const auto control = damiaoControl(own.text("control"));
  const bool can_fd = own.flag("can_fd");
  MotorTraits traits;
  traits.min_id = 1;
  traits.max_id = damiao::kMaxId;
  traits.gear_ratio = model.gear_ratio;
  traits.effort = CommandUnit::kAmpere;
  traits.effort_full_scale = model.current_max_a;
  traits.torque_nm_per_a = model.torque_nm_per_a;
  traits.no_load_rpm = model.no_load_rpm;
  traits.reported_rpm = static_cast<float>(damiaoFastestRadS(model, scaleOf(model, own)) / kRadPerSPerRpm);
  traits.nominal_v = model.nominal_v;
  traits.rotor_inertia_kg_m2 = model.rotor_inertia_kg_m2;
  traits.phase_resistance_ohm = model.phase_resistance_ohm;
  traits.absolute = model.output_encoder;
  traits.frozen_a = static_cast<float>(scaleOf(model, own).t_max_nm) / model.torque_nm_per_a;
  traits.signed_a = traits.frozen_a;
  if (!boundsCurrent(control))
    traits.unseen_limit_remedy =
        "its drive obeys a limit that no frame carries; write control: mit or force_position";
  traits.yields = control == DamiaoControl::kForcePosition;
  traits.scaled_speed = true;
  traits.bounds_effort = boundsCurrent(control);
  traits.asked = true;
  traits.restart_silence =
      DamiaoPosition::longestSilence(scaleOf(model, own), damiaoFastestRadS(model, scaleOf(model, own)));
  traits.silence_key = "p_max_rad";
  traits.fd = can_fd;
  traits.data_bitrate = can_fd ? 5'000'000 : 0;
  traits.classic_only = !can_fd;
  traits.watchdog = true;
  traits.modes = modes(control);
  if (control == DamiaoControl::kMit) traits.spring_range = {kKpMax, kKdMax};
  traits.frames = driveFrames(control);
  traits.setup = &damiaoSetup();
  return traits;
}

std::string digits(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// Error if a gain at the output shaft exceeds the range of the drive's field.
Result<void> checkGain(const MotorSettings& settings, std::string_view key, double most) {
  const auto* model = findDamiaoModel(settings.model);
  const double gear = model != nullptr ? gearRatioOf(settings, *model) / model->gear_ratio : 1.0;
  const double most_at_shaft = most * gear * gear;
  if (settings.own.number(key) <= most_at_shaft) return {};
  return fail(std::string(key) + ": the drive takes at most " + digits(most_at_shaft));
}

Result<void> DamiaoFamily::check(const MotorSettings& settings) const {
  const auto own = damiaoSettings(settings);
  if ((own.master_id & damiao::kAddressMask) == static_cast<std::uint32_t>(settings.id)) {
    return fail("master_id: a Damiao drive takes every frame whose id ends in its own (" +
                std::to_string(settings.id) + ", of 256) as meant for it; set another Master ID, such as " +
                std::to_string(settings.id + 16));
  }
  if (own.master_id == damiao::kRegisterId) {
    return fail("master_id: 2047 is the id on which all Damiao drives are asked for registers");
  }
  const double period_ms = 1000.0 * settings.command_divider / settings.tick_hz;
  if (settings.own.number("watchdog_ms") < 3.0 * period_ms) {
    return fail("watchdog_ms: must be at least three times as long as the spacing of commands, " +
                digits(period_ms) + " ms");
  }
  const auto* model = findDamiaoModel(settings.model);
  if (!boundsCurrent(own.control) && model != nullptr && settings.effort_limit > 0.0F &&
      settings.effort_limit < model->current_max_a) {
    return fail("current_limit_a: control " + settings.own.text("control") +
                " has no limit of current; use control mit or force_position, or set the drive's own "
                "(Overcurrent) with the vendor's tool");
  }
  for (const std::string_view key : {"velocity_damping_nms_per_rad", "angle_damping_nms_per_rad"}) {
    if (auto ok = checkGain(settings, key, kKdMax); !ok) return ok;
  }
  return checkGain(settings, "angle_stiffness_nm_per_rad", kKpMax);
}

BusUse DamiaoFamily::busUse(const MotorSettings& settings) const {
  const auto own = damiaoSettings(settings);
  const auto id = static_cast<std::uint32_t>(settings.id);
  const auto byte = static_cast<std::uint8_t>(settings.id);
  const CanId control_id{(static_cast<std::uint32_t>(own.control) - 1U) * 0x100U + id, false};
  const CanId master_id{own.master_id, false};
  const auto shape = [&own](std::size_t length) {
    return FrameShape{.fd = own.can_fd, .bit_rate_switch = own.can_fd, .length = length};
  };
  const double per_second = static_cast<double>(settings.tick_hz) / settings.command_divider;
  BusUse use;
  use.sends = {
      {.id = master_id, .mask = kStandardIdMask, .discriminators = {PayloadDiscriminator{0, 0x0F, byte}}}};
  use.obeys = {{.id = {id, false}, .mask = damiao::kAddressMask},
               {.id = {damiao::kRegisterId, false},
                .mask = kStandardIdMask,
                .discriminators = {PayloadDiscriminator{0, 0xFF, byte}}}};
  // One id for each control mode. The drive also takes others that end in its id; devices may have those.
  for (std::uint32_t mode = 0; mode < 4; ++mode)
    use.steers.push_back({.id = {mode * 0x100U + id, false}, .mask = kStandardIdMask});
  // A register that is written may be a scale, the control mode or the watchdog.
  use.steers.push_back(
      {.id = {damiao::kRegisterId, false},
       .mask = kStandardIdMask,
       .discriminators = {PayloadDiscriminator{.byte_index = 0, .value = byte},
                          PayloadDiscriminator{.byte_index = 2, .value = damiao::kWriteOperation}}});
  use.feedback = {{master_id, shape(8), per_second}};
  use.commands = {{control_id, shape(own.control == DamiaoControl::kVelocity ? 4 : 8), per_second}};
  return use;
}

}  // namespace

const MotorFamily& damiaoFamily() noexcept {
  static const DamiaoFamily kFamily;
  return kFamily;
}

DamiaoSettings damiaoSettings(const MotorSettings& settings) {
  const auto* found = findDamiaoModel(settings.model);
  const DamiaoModel& model = found != nullptr ? *found : damiaoModels().front();
  const auto& own = settings.own;
  const double own_gear = gearRatioOf(settings, model) / model.gear_ratio;
  const double gain = own_gear * own_gear;
  const double steps = own.number("watchdog_ms") / damiao::kTimeoutStepMs;
  return {
      .master_id = static_cast<std::uint32_t>(own.integer("master_id")) & kStandardIdMask,
      .control = damiaoControl(own.text("control")),
      // 0 would switch it off.
      .timeout = static_cast<std::uint32_t>(std::max(1.0, std::round(steps))),
      .scale = scaleOf(model, own),
      .gains = {given(own, "velocity_damping_nms_per_rad", gain * model.gains.velocity_damping_nms_per_rad),
                given(own, "angle_stiffness_nm_per_rad", gain * model.gains.angle_stiffness_nm_per_rad),
                given(own, "angle_damping_nms_per_rad", gain * model.gains.angle_damping_nms_per_rad)},
      .can_fd = own.flag("can_fd")};
}

}  // namespace rc10
