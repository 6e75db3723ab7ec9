#include "drives/moteus/moteus_family.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "app/units.hpp"
#include "drives/moteus/moteus_model.hpp"
#include "drives/moteus/moteus_motor.hpp"

namespace rc10 {
namespace {

using Kind = OwnKey::Kind;

constexpr std::array<std::string_view, 1> kMoteusModels{"moteus"};

constexpr std::array kMoteusKeys{
    OwnKey{.name = "motor_kv_rpm_per_v",
           .kind = Kind::kNumber,
           .unit = "rpm/V",
           .min = 0.0,
           .max = 10'000.0,
           .above_min = true,
           .required = true,
           .about = "motor.Kv of the drive, as its calibration has found it. Amperes become torque with "
                    "8.27 / Kv Nm/A, as in the drive."},
    OwnKey{.name = "rotor_to_output_ratio",
           .kind = Kind::kNumber,
           .min = 0.0,
           .max = 10.0,
           .above_min = true,
           .default_text = "1",
           .about = "motor_position.rotor_to_output_ratio of the drive: 0.1 for a 10:1 gear that it "
                    "counts in its position. A gear that the drive knows nothing of goes into gear_ratio, "
                    "which is always that of all gears."},
    OwnKey{.name = "absolute",
           .kind = Kind::kFlag,
           .default_text = "false",
           .about =
               "The drive knows its output angle at power-up: a direct drive, or an encoder on the output. "
               "Enabling checks its home state: 2 (output), or 1 (rotor) for a direct drive."},
    OwnKey{.name = "watchdog_ms",
           .kind = Kind::kInteger,
           .unit = "ms",
           .min = 10,
           .max = 1000,
           .default_text = "100",
           .about = "The drive's own watchdog: without a command for so long it stops by itself. At least "
                    "three commands long."},
    OwnKey{.name = "can_prefix",
           .kind = Kind::kInteger,
           .min = 0,
           .max = 0x1FFF,
           .default_text = "0",
           .about = "can.prefix of the drive: keeps its ids apart from those of other families."},
    OwnKey{.name = "bit_rate_switch",
           .kind = Kind::kFlag,
           .default_text = "true",
           .about = "Send the data at the data bit rate. false: all at the nominal one, for a cable or "
                    "transceiver that is too slow for it."}};

// The factory's servo.max_current_A: 100 A (r4.5, r4.8, r4.11, n1), 20 A (c1), 120 A (x1), the drive's own
// bound in any case. Source: fw/bldc_servo_structs.h.
constexpr float kFullScaleA = 100.0F;

constexpr DriveFrames kMoteusFrames{.rest = Provision::kFrame,
                                    .poll = Provision::kFrame,
                                    .idle = Provision::kFrame,
                                    .damp = Provision::kFrame,
                                    .brake = Provision::kFrame,
                                    .hold = Provision::kFrame,
                                    .enable = Provision::kFrame,
                                    .disable = Provision::kNothing,
                                    .brake_resists = true};

[[nodiscard]] int commandHz(const MotorSettings& settings) noexcept {
  return std::max(1, settings.tick_hz / std::max(1, settings.command_divider));
}

class MoteusFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "moteus"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override { return kMoteusModels; }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kMoteusKeys; }

  [[nodiscard]] MotorTraits traits(std::string_view /*model*/, const OwnValues& own) const override {
    const double gear_ratio = 1.0 / moteusSettings(own).rotor_to_output_ratio;
    const double kv_rpm_per_v = own.number("motor_kv_rpm_per_v");
    MotorTraits traits;
    traits.max_id = 126;  // fw/moteus.cc; 127 is meant for all
    traits.gear_ratio = gear_ratio;
    traits.effort = CommandUnit::kAmpere;
    traits.effort_full_scale = kFullScaleA;
    traits.torque_nm_per_a =
        kv_rpm_per_v > 0.0 ? static_cast<float>(kTorqueTimesKv / kv_rpm_per_v * gear_ratio) : 0.0F;
    traits.frozen_a = kFullScaleA;
    traits.signed_a = traits.frozen_a;
    traits.limit_by_report = true;
    traits.nominal_v = 24.0F;
    traits.no_load_rpm = static_cast<float>(kv_rpm_per_v * 24.0 / gear_ratio);
    traits.absolute = own.flag("absolute");
    traits.asked = true;
    traits.fd = true;
    traits.data_bitrate = 5'000'000;
    traits.classic_only = false;
    traits.watchdog = true;
    traits.modes = ModeSet{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                           ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kBrake};
    static constexpr DriveSetup kSetup{
        .tool = "moteus_tool or tview (moteus has its settings on its diagnostic stream)"};
    traits.setup = &kSetup;
    traits.frames = kMoteusFrames;
    return traits;
  }

  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override {
    const int watchdog_ms = moteusSettings(settings.own).watchdog_ms;
    if (watchdog_ms * commandHz(settings) >= 3000) return {};
    return fail("watchdog_ms: " + std::to_string(watchdog_ms) + " ms are less than three commands at " +
                std::to_string(commandHz(settings)) + " Hz; give at least " +
                std::to_string((3000 + commandHz(settings) - 1) / commandHz(settings)) +
                ", or lower command_divider");
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const MoteusSettings own = moteusSettings(settings.own);
    const auto id = static_cast<std::uint32_t>(settings.id);
    const CanId query = moteus::queryId(own.can_prefix, id);
    const CanId reply = moteus::replyId(own.can_prefix, id);
    BusUse use;
    use.sends = {FrameFilter{.id = reply}};
    // Its hardware filters: the prefix and the low byte, whatever the source, in extended ids; the low byte
    // in standard ones. 0x7F is meant for every drive. Source: fw/moteus.cc.
    constexpr std::uint32_t kExtendedMask = 0x1FFF'00FFU;
    constexpr std::uint32_t kStandardMask = 0xFFU;
    constexpr std::uint32_t kEverybody = 0x7F;
    for (const std::uint32_t destination : {id, kEverybody}) {
      use.obeys.push_back({.id = {own.can_prefix << 16U | destination, true}, .mask = kExtendedMask});
      use.obeys.push_back({.id = {destination, false}, .mask = kStandardMask});
    }
    // Commands begin with a write of a register (0x00 to 0x0F), questions with a read.
    use.steers = use.obeys;
    for (auto& filter : use.steers) filter.discriminators = {PayloadDiscriminator{0, 0xF0, 0x00}};
    // A vendor's tool writes "d pos", "d stop" to the drive's console: a stream of bytes (0x40, channel,
    // length) in which other commands have other first letters. Source: docs/protocol/can.md.
    for (auto filter : use.obeys) {
      filter.discriminators = {PayloadDiscriminator{.byte_index = 0, .value = 0x40},
                               PayloadDiscriminator{.byte_index = 3, .value = 'd'}};
      use.steers.push_back(filter);
    }
    const auto shape = [&own](CanId of, std::size_t length) {
      return FrameShape{
          .extended = of.extended, .fd = true, .bit_rate_switch = own.bit_rate_switch, .length = length};
    };
    const auto per_second = static_cast<double>(commandHz(settings));
    use.feedback = {{reply, shape(reply, 32), per_second}};
    use.commands = {{query, shape(query, 48), per_second}};
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    return registerSolo(std::make_unique<Moteus_Motor>(settings, traits(settings.model, settings.own)),
                        parts);
  }
};

}  // namespace

const MotorFamily& moteusFamily() noexcept {
  static const MoteusFamily kFamily;
  return kFamily;
}

}  // namespace rc10
