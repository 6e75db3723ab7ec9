#include "drives/lktech/lktech_family.hpp"

#include <algorithm>
#include <array>

#include "app/units.hpp"
#include "drives/lktech/lktech_group.hpp"
#include "drives/lktech/lktech_model.hpp"
#include "drives/lktech/lktech_motor.hpp"

namespace rc10 {
namespace {

constexpr std::array<OwnKey, 3> kLktechKeys{{
    {.name = "group",
     .kind = OwnKey::Kind::kFlag,
     .default_text = "false",
     .about = "Currents of the ids 1 to 4 go together in the frame 0x280; current and coast targets only, no "
              "brake and no hold."},
    {.name = "torque_nm_per_a",
     .kind = OwnKey::Kind::kNumber,
     .unit = "Nm/A",
     .min = 0,
     .max = 100,
     .default_text = "0",
     .about = "Torque at the drive's output for each ampere; 0.81 for MF9025 with the winding 35T. 0: the "
              "model's own."},
    {.name = "encoder_bits",
     .kind = OwnKey::Kind::kInteger,
     .min = 14,
     .max = 16,
     .default_text = "16",
     .about = "Bits of the encoder value in answers; 16 also for encoders of 18 bits."},
}};

constexpr DriveFrames kLktechFrames{.rest = Provision::kFrame,
                                    .poll = Provision::kFrame,
                                    .idle = Provision::kFrame,
                                    .damp = Provision::kUnsupported,
                                    .brake = Provision::kFrame,
                                    .hold = Provision::kFrame,
                                    .enable = Provision::kFrame,
                                    .disable = Provision::kNothing};

class LktechFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "LK-Tech"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override {
    return lktechModelNames();
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kLktechKeys; }

  [[nodiscard]] MotorTraits traits(std::string_view name, const OwnValues& own) const override {
    const LktechModel* const found = findLktechModel(name);
    const LktechModel model = found != nullptr ? *found : LktechModel{};
    const double own_torque = own.number("torque_nm_per_a");
    MotorTraits traits;
    traits.max_id = own.flag("group") ? lktech::kGroupSize : lktech::kMaxId;
    traits.gear_ratio = model.gear_ratio;
    traits.effort = CommandUnit::kAmpere;
    traits.effort_full_scale = model.peak_current_a;
    traits.torque_nm_per_a = own_torque > 0.0
                                 ? static_cast<float>(own_torque)
                                 : model.rotor_torque_nm_per_a * static_cast<float>(model.gear_ratio);
    if (!(traits.torque_nm_per_a > 0.0F)) traits.unreported_torque_remedy = "write torque_nm_per_a";
    traits.nominal_v = 24.0F;
    // 16 bits of degrees per second of the rotor.
    traits.reported_rpm = static_cast<float>(32767.0 / kDegPerSPerRpm / model.gear_ratio);
    traits.absolute = true;  // direct drives, and gears with a second encoder at the output (E)
    traits.frozen_a = static_cast<float>(model.amperes_per_raw * lktech::kRawCurrentMax);
    traits.signed_a = traits.frozen_a;
    traits.limit_by_report = true;
    traits.asked = true;
    // After a shorter silence the encoder shows which way it went.
    traits.restart_silence = std::chrono::milliseconds{100};
    traits.unseen_start = std::chrono::milliseconds{300};  // its count may be as before; no source: cautious
    static constexpr DriveSetup kSetup{.tool = "LK Motor Tool (over its serial port)"};
    traits.setup = &kSetup;
    traits.frames = kLktechFrames;
    traits.modes = ModeSet{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                           ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kBrake};
    if (!own.flag("group")) {
      traits.own_limit_key = "current_limit_a";
      traits.own_loops = ModeSet{ControlMode::kAngle, ControlMode::kTotalAngle};
    } else {
      traits.modes = ModeSet{ControlMode::kCoast, ControlMode::kCurrent};
      traits.frames.brake = Provision::kUnsupported;
      traits.frames.hold = Provision::kUnsupported;
    }
    // "Input signal lost" is an error of newer firmware, but no public document tells how to set its time.
    traits.watchdog = false;
    return traits;
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const bool grouped = settings.own.flag("group");
    const auto one = [](std::uint32_t value) {
      return FrameFilter{.id = {value, false}, .mask = kStandardIdMask};
    };
    const std::uint32_t own_id = lktech::kBaseId + static_cast<std::uint32_t>(settings.id);
    const double told_hz = static_cast<double>(settings.tick_hz) / std::max(settings.command_divider, 1);
    constexpr double kQueriesHz = 20.0;
    BusUse use;
    use.sends = {one(own_id)};
    use.obeys = {one(own_id)};
    if (settings.id <= lktech::kGroupSize) {
      // Currents; and by one source speeds (0x281), angles (0x282) and a mixture (0x288).
      for (const std::uint32_t id : {lktech::kGroupId, 0x281U, 0x282U, 0x288U}) use.obeys.push_back(one(id));
    }
    // 0xA0 to 0xAF move it; 0x80 and 0x81 switch it off and stop it, 0x88 and 0x8C switch it on and brake it,
    // 0x9B clears the error that has stopped it.
    for (const auto code : {PayloadDiscriminator{0, 0xF0, 0xA0}, PayloadDiscriminator{0, 0xFE, 0x80},
                            PayloadDiscriminator{0, 0xFB, 0x88}, PayloadDiscriminator{0, 0xFF, 0x9B}})
      use.steers.push_back({.id = {own_id, false}, .mask = kStandardIdMask, .discriminators = {code}});
    use.steers.insert(use.steers.end(), use.obeys.begin() + 1, use.obeys.end());
    use.feedback = {{.id = {own_id, false}, .shape = {}, .per_second = told_hz + kQueriesHz}};
    if (grouped) {
      use.commands = {{.id = {lktech::kGroupId, false}, .shape = {}, .per_second = told_hz},
                      {.id = {own_id, false}, .shape = {}, .per_second = kQueriesHz}};
      use.layout = "LK-Tech 0x280";
    } else {
      use.commands = {{.id = {own_id, false}, .shape = {}, .per_second = told_hz + kQueriesHz}};
    }
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    auto motor = std::make_unique<LKTech_Motor>(settings, traits(settings.model, settings.own));
    if (motor->grouped()) {
      const CanId id{lktech::kGroupId, false};
      auto* group = parts.find<LKTech_Group>(id);
      if (group == nullptr) {
        if (auto added = parts.add(std::make_unique<LKTech_Group>()); !added)
          return tl::unexpected(added.error());
        group = parts.find<LKTech_Group>(id);
      }
      if (auto member = group->registerMotor(*motor); !member) return tl::unexpected(member.error());
    }
    return registerSolo(std::move(motor), parts);
  }
};

}  // namespace

const MotorFamily& lktechFamily() noexcept {
  static const LktechFamily kFamily;
  return kFamily;
}

}  // namespace rc10
