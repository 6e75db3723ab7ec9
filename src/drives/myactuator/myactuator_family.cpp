#include "drives/myactuator/myactuator_family.hpp"

#include <array>

#include "app/units.hpp"
#include "drives/myactuator/myactuator_model.hpp"
#include "drives/myactuator/myactuator_motor.hpp"

namespace rc10 {
namespace {

constexpr std::array<OwnKey, 4> kMyactuatorKeys{{
    {.name = "angle_divider",
     .kind = OwnKey::Kind::kInteger,
     .min = 1,
     .max = 100,
     .default_text = "1",
     .about = "The angle (0x92) is asked for with every n-th command: it is a request of its own. The "
              "feedback rate is that of the angles."},
    {.name = "torque_nm_per_a",
     .kind = OwnKey::Kind::kNumber,
     .unit = "Nm/A",
     .min = 0,
     .max = 100,
     .default_text = "0",
     .about = "Torque at the drive's output for each ampere. RMD-X without it: no impedance, no damp, no "
              "torque reading. 0: the model's own."},
    {.name = "absolute_encoder",
     .kind = OwnKey::Kind::kFlag,
     .default_text = "false",
     .about = "The drive has a second encoder and knows the angle of its output after power-up."},
    {.name = "release_brake",
     .kind = OwnKey::Kind::kFlag,
     .default_text = "false",
     .about =
         "Enabling opens the drive's holding brake (0x77). The drive opens it by itself for velocity and "
         "angle targets, not for current or impedance. A load that hangs on it falls until the first "
         "target."},
}};

// V4.2 publishes neither; X6-60's data sheet has 176 rpm without load and 153 rpm rated.
constexpr float kNoLoadPerRated = 176.0F / 153.0F;

constexpr DriveFrames kMyactuatorFrames{.rest = Provision::kFrame,
                                        .poll = Provision::kFrame,
                                        .idle = Provision::kFrame,
                                        .damp = Provision::kFrame,
                                        .brake = Provision::kFrame,
                                        .hold = Provision::kFrame,
                                        .enable = Provision::kFrame,
                                        .disable = Provision::kNothing};

class MyactuatorFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "MyActuator"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override {
    return myactuatorModelNames();
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kMyactuatorKeys; }

  [[nodiscard]] MotorTraits traits(std::string_view name, const OwnValues& own) const override {
    const MyactuatorModel* const found = findMyactuatorModel(name);
    const MyactuatorModel model = found != nullptr ? *found : MyactuatorModel{};
    const double own_torque = own.number("torque_nm_per_a");
    MotorTraits traits;
    traits.max_id = myactuator::kMaxId;
    traits.gear_ratio = model.gear_ratio;
    traits.effort = CommandUnit::kAmpere;
    traits.effort_full_scale = model.peak_current_a;
    traits.torque_nm_per_a = own_torque > 0.0 ? static_cast<float>(own_torque) : model.torque_nm_per_a;
    traits.no_load_rpm = model.rated_rpm * kNoLoadPerRated;
    // The motion mode ends where some models are slower than their no-load speed: those are watched in the
    // other modes alone (16 bits of degrees per second).
    constexpr double kMotionRpm = myactuator::kMotionVelocityRadS / kRadPerSPerRpm;
    const bool ends_early = traits.no_load_rpm > 0.0F && static_cast<double>(traits.no_load_rpm) < kMotionRpm;
    traits.reported_rpm = static_cast<float>(ends_early ? kMotionRpm : 32767.0 / kDegPerSPerRpm);
    traits.nominal_v = model.nominal_v;
    traits.absolute = own.flag("absolute_encoder");
    traits.frozen_a = model.peak_current_a;
    traits.signed_a = traits.frozen_a;
    traits.limit_by_report = true;
    traits.own_limit_key = "current_limit_a";
    traits.own_peak_a = model.rated_rpm > 0.0F ? model.peak_current_a : 0.0F;
    traits.own_loops = ModeSet{ControlMode::kVelocity, ControlMode::kAngle, ControlMode::kTotalAngle};
    traits.scaled_speed = true;  // of the motion mode
    traits.asked = true;
    // No such drive starts faster: its bootloader alone takes longer.
    traits.restart_silence = std::chrono::milliseconds{100};
    traits.frames = kMyactuatorFrames;
    traits.setup = &myactuatorSetup();
    traits.modes = ModeSet{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                           ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kImpedance,
                           ControlMode::kBrake};
    traits.spring_range = {myactuator::kMotionStiffness, myactuator::kMotionDamping};
    if (!(traits.torque_nm_per_a > 0.0F)) {
      // The motion mode speaks of torque: without the constant it cannot be bounded.
      traits.modes = ModeSet{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                             ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kBrake};
      traits.frames.damp = Provision::kUnsupported;
      traits.unreported_torque_remedy = "write torque_nm_per_a";
    }
    traits.samples_every = std::max(own.integer("angle_divider"), 1);
    // It has one (0xB3), but setting it writes its ROM and nothing reads it back.
    traits.watchdog = false;
    return traits;
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const auto id = static_cast<std::uint32_t>(settings.id);
    const auto one = [](std::uint32_t value) {
      return FrameFilter{.id = {value, false}, .mask = kStandardIdMask};
    };
    const double told_hz = static_cast<double>(settings.tick_hz) / std::max(settings.command_divider, 1);
    const double angles_hz = told_hz / std::max(settings.own.integer("angle_divider"), 1);
    constexpr double kQueriesHz = 20.0;
    const double all_hz = told_hz + angles_hz + kQueriesHz;
    BusUse use;
    use.sends = {one(myactuator::kReplyBase + id), one(myactuator::kMotionReplyBase + id)};
    use.obeys = {one(myactuator::kRequestBase + id), one(myactuator::kMotionBase + id),
                 one(myactuator::kBroadcastId), one(myactuator::kIdSettingId)};
    // 0xA0 to 0xAF move it; 0x80 and 0x81 switch it off and stop it; 0x76 restarts it, 0x77 and 0x78 release
    // and lock its brake.
    for (const auto request : {myactuator::kRequestBase + id, myactuator::kBroadcastId}) {
      for (const auto code : {PayloadDiscriminator{0, 0xF0, 0xA0}, PayloadDiscriminator{0, 0xFE, 0x80},
                              PayloadDiscriminator{0, 0xFE, 0x76}, PayloadDiscriminator{0, 0xFF, 0x78}})
        use.steers.push_back({.id = {request, false}, .mask = kStandardIdMask, .discriminators = {code}});
    }
    use.steers.push_back(one(myactuator::kMotionBase + id));
    use.feedback = {{.id = use.sends[0].id, .shape = {}, .per_second = all_hz}};
    use.commands = {{.id = use.obeys[0].id, .shape = {}, .per_second = all_hz}};
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    return registerSolo(std::make_unique<MyActuator_Motor>(settings, traits(settings.model, settings.own)),
                        parts);
  }
};

}  // namespace

const MotorFamily& myactuatorFamily() noexcept {
  static const MyactuatorFamily kFamily;
  return kFamily;
}

}  // namespace rc10
