#include "drives/dji/dji_family.hpp"

#include <array>
#include <memory>
#include <string>

#include "drives/dji/dji_group.hpp"
#include "drives/dji/dji_ids.hpp"
#include "drives/dji/dji_motor.hpp"

namespace rc10 {
namespace {

constexpr std::array<std::string_view, 2> kCommands{"current", "voltage"};
constexpr std::array kDjiKeys{
    OwnKey{.name = "command",
           .kind = OwnKey::Kind::kChoice,
           .choices = kCommands,
           .default_text = "current",
           .about = "What the drive is told. voltage: GM6020 only. GM6020 current: newer firmware, with "
                    "'current ring' enabled in RoboMaster Assistant."}};

constexpr int kDjiBitrate = 1'000'000;  // C620, C610 and GM6020 know no other

// Every DJI frame, either direction.
constexpr FrameShape kShape{.extended = false, .fd = false, .bit_rate_switch = false, .length = 8};

[[nodiscard]] DjiCommand commandOf(const DjiModel& model, const OwnValues& own) {
  return model.voltage.exists() ? djiSettings(own).command : DjiCommand::kCurrent;
}

class DjiFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "DJI"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override {
    static const std::array<std::string_view, 3> kNames{kM3508.name, kM2006.name, kGM6020.name};
    return kNames;
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kDjiKeys; }

  [[nodiscard]] MotorTraits traits(std::string_view name, const OwnValues& own) const override {
    const DjiModel& model = *findDjiModel(name);
    const DjiCommand command = commandOf(model, own);
    const DjiCommandTable& table = model.command(command);
    const bool by_current = command == DjiCommand::kCurrent;
    MotorTraits traits;
    traits.min_id = 1;
    traits.max_id = model.max_id;
    traits.gear_ratio = model.gear_ratio;
    traits.effort = by_current ? CommandUnit::kAmpere : CommandUnit::kVolt;
    traits.effort_full_scale = table.full_scale;
    traits.torque_nm_per_a = model.rotor_torque_nm_per_a * static_cast<float>(model.gear_ratio);
    traits.no_load_rpm = model.no_load_rpm;
    traits.reported_rpm = static_cast<float>(32767.0 / model.gear_ratio);  // 16 bits of rpm of the rotor
    traits.min_feedback_hz = 200;
    traits.unseen_start = std::chrono::milliseconds{300};  // no source: cautious
    traits.absolute = model.absolute_output;
    traits.reports_temperature = model.reports_temperature;
    traits.frozen_a = model.current.full_scale;
    traits.signed_a = traits.frozen_a;
    traits.modes =
        ModeSet{ControlMode::kCoast,      by_current ? ControlMode::kCurrent : ControlMode::kVoltage,
                ControlMode::kVelocity,   ControlMode::kAngle,
                ControlMode::kTotalAngle, ControlMode::kBrake};
    static constexpr DriveSetup kSetup{.tool =
                                           "its button or switches (the id), and DJI's RoboMaster Assistant"};
    traits.setup = &kSetup;
    traits.frames = kDjiFrames;
    traits.host_loops = &table.default_loops;
    return traits;
  }

  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override {
    const DjiModel& model = *findDjiModel(settings.model);
    if (model.command(djiSettings(settings.own).command).exists()) return {};
    return fail("command: the " + settings.model +
                " obeys currents only; remove it, or write command: current");
  }

  [[nodiscard]] int bitrate() const noexcept override { return kDjiBitrate; }
  [[nodiscard]] IdJudge idJudge() const noexcept override { return djiIdConflicts; }
  [[nodiscard]] std::vector<KeyBound> keyBounds(std::string_view name) const override {
    const DjiModel& model = *findDjiModel(name);
    std::vector<KeyBound> bounds{
        {.key = "current_limit_a", .most = static_cast<double>(model.current.full_scale)}};
    if (model.voltage.exists()) {
      bounds.push_back({.key = "voltage_limit_v", .most = static_cast<double>(model.voltage.full_scale)});
    } else {
      bounds.push_back({.key = "command", .kind = KeyBound::Kind::kOnly, .only = "current"});
      bounds.push_back({.key = "voltage_limit_v", .kind = KeyBound::Kind::kNone});
    }
    if (!model.absolute_output) bounds.push_back({.key = "zero_deg", .kind = KeyBound::Kind::kNone});
    return bounds;
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const DjiModel& model = *findDjiModel(settings.model);
    const CanId sends = djiFeedbackId(model, settings.id);
    const CanId obeys = djiCommandId(model, djiSettings(settings.own).command, settings.id);
    const bool gimbal = &model == &kGM6020;
    BusUse use;
    use.sends = {FrameFilter{.id = sends}};
    use.obeys = {FrameFilter{.id = obeys}};
    use.feedback = {{sends, kShape, static_cast<double>(settings.feedback_hz)}};
    use.commands = {{obeys, kShape, static_cast<double>(settings.tick_hz)}};
    use.layout = gimbal ? "GM6020 commands" : "C620 and C610 currents";
    use.slot = djiSlot(settings.id) + 1;
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    if (auto checked = DJI_Motor::check(settings); !checked) return tl::unexpected(checked.error());
    auto motor = std::make_unique<DJI_Motor>(settings);
    if (auto listens = parts.bus().registerMotor(*motor); !listens) return tl::unexpected(listens.error());
    auto* group = parts.find<DJI_Group>(motor->commandId());
    if (group != nullptr) {
      if (auto joined = group->registerMotor(*motor); !joined) return tl::unexpected(joined.error());
      return motor;
    }
    auto made = std::make_unique<DJI_Group>(motor->commandId());
    if (auto joined = made->registerMotor(*motor); !joined) return tl::unexpected(joined.error());
    if (auto added = parts.add(std::move(made)); !added) return tl::unexpected(added.error());
    return motor;
  }
};

}  // namespace

const MotorFamily& djiFamily() noexcept {
  static const DjiFamily kFamily;
  return kFamily;
}

}  // namespace rc10
