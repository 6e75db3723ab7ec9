#include "drives/odrive/odrive_family.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "drives/odrive/odrive_motor.hpp"

namespace rc10 {
namespace {

using Kind = OwnKey::Kind;

constexpr double kHeartbeatHz = 10.0;
constexpr double kLimitsHz = 2.0;
// Unaddressed 0.6 drives listen here for their address; it is nobody's node.
constexpr int kHighestNode = 62;
constexpr CanId kAddressBroadcast{0x7E6, false};

constexpr std::array kOdriveKeys{
    OwnKey{.name = "torque_constant_nm_per_a",
           .kind = Kind::kNumber,
           .unit = "Nm/A",
           .min = 0.0,
           .max = 100.0,
           .above_min = true,
           .required = true,
           .about = "Torque per ampere of the motor itself, the same as motor.config.torque_constant on "
                    "the drive (8.27 divided by its KV). Targets in A are sent as torque."},
    OwnKey{.name = "telemetry_hz",
           .kind = Kind::kInteger,
           .unit = "Hz",
           .min = 0.0,
           .max = 100.0,
           .default_text = "0",
           .about = "How often the drive sends current or torque, temperature and bus voltage, as set on "
                    "it. 0: these are not reported."},
    OwnKey{.name = "iq_reversed",
           .kind = Kind::kFlag,
           .default_text = "false",
           .about = "ODrive v3 only: the calibration found encoder.config.direction = -1, so its current "
                    "counts the other way."},
};

// Loops run on the drive. Damping has no mode of its own there, nor has an impedance.
constexpr DriveFrames kOdriveFrames{.rest = Provision::kFrame,
                                    .poll = Provision::kNothing,
                                    .idle = Provision::kFrame,
                                    .damp = Provision::kUnsupported,
                                    .brake = Provision::kFrame,
                                    .hold = Provision::kFrame,
                                    .enable = Provision::kFrame,
                                    .disable = Provision::kNothing};

constexpr ModeSet kOdriveModes{ControlMode::kCoast, ControlMode::kCurrent,    ControlMode::kVelocity,
                               ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kBrake};

class OdriveFamily : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "ODrive"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override {
    return odriveModelNames();
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kOdriveKeys; }

  [[nodiscard]] MotorTraits traits(std::string_view model, const OwnValues& own) const override {
    const auto* row = findOdriveModel(model);
    const bool telemetry = own.integer("telemetry_hz") > 0;
    MotorTraits traits;
    traits.min_id = 0;
    traits.max_id = kHighestNode;
    traits.effort_full_scale = row != nullptr ? row->peak_current_a : 0.0F;
    traits.torque_nm_per_a = static_cast<float>(own.number("torque_constant_nm_per_a"));
    traits.reports_temperature = telemetry && row != nullptr && row->firmware == OdriveFirmware::k06;
    // traits.frozen_a stays 0: the current comes too rarely to tell a frozen drive by it.
    if (telemetry) traits.signed_a = traits.effort_full_scale;
    traits.limit_by_report = telemetry;
    if (!telemetry) {
      traits.unseen_limit_remedy = traits.unreported_current_remedy = traits.unreported_torque_remedy =
          "let it send its current and write telemetry_hz";
    }
    traits.signed_current_hz = own.integer("telemetry_hz");
    // encoder_rate_ms (0.5), encoder_msg_rate_ms (0.6): 10 ms as delivered, whole milliseconds.
    traits.feedback_hz = 100;
    traits.max_feedback_hz = 1000;
    traits.modes = kOdriveModes;
    static constexpr DriveSetup kSetup{.tool = "odrivetool (CANSimple reads none of its settings back)"};
    traits.setup = &kSetup;
    traits.frames = kOdriveFrames;
    // traits.watchdog stays false: there is one (enable_watchdog), but no message sets or reads it. Firmware
    // 0.6 could through RxSdo, with endpoint numbers that change with every release.
    return traits;
  }

  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override {
    // One message sets both limits, and nothing reads back what is there.
    if (!(settings.velocity_limit_rpm > 0.0F)) {
      return fail(
          "velocity_limit_rpm: an ODrive needs one; it is told its velocity and current limit together");
    }
    if (!(settings.effort_limit > 0.0F)) {
      return fail("current_limit_a: an ODrive needs one, as its motor is not known");
    }
    return {};
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const int node = settings.id;
    const auto* row = findOdriveModel(settings.model);
    const bool v06 = row == nullptr || row->firmware == OdriveFirmware::k06;
    const FrameFilter own_block{.id = odrive::canId(node, odrive::Message{}), .mask = odrive::kNodeMask};
    BusUse use;
    use.sends = {own_block};
    use.obeys = {own_block};
    if (v06) use.obeys.push_back({.id = kAddressBroadcast, .mask = kStandardIdMask});
    using odrive::Message;
    const auto steered_by = [&use, node](Message message) {
      use.steers.push_back({.id = odrive::canId(node, message), .mask = kStandardIdMask});
    };
    for (const auto message :
         {Message::kEstop, Message::kSetAxisState, Message::kSetControllerMode, Message::kSetInputPos,
          Message::kSetInputVel, Message::kSetInputTorque, Message::kSetLimits, Message::kReboot,
          Message::kClearErrors, Message::kSetPosition, Message::kSetTrajVelocity,
          Message::kSetTrajAcceleration, Message::kSetTrajInertia, Message::kSetPositionGain,
          Message::kSetVelocityGains})
      steered_by(message);
    if (v06) {
      steered_by(Message::kEnterDfu);
      use.steers.push_back({.id = odrive::canId(node, Message::kRxSdo),
                            .mask = kStandardIdMask,
                            .discriminators = {PayloadDiscriminator{.value = odrive::kSdoWrite}}});
    } else {
      for (const auto message : {Message::kStartAnticogging, Message::kSetNodeId}) steered_by(message);
    }

    const double feedback_hz = settings.feedback_hz > 0 ? settings.feedback_hz : 100.0;
    use.feedback = {{odrive::canId(node, odrive::Message::kEncoderEstimates), FrameShape{}, feedback_hz},
                    {odrive::canId(node, odrive::Message::kHeartbeat), FrameShape{}, kHeartbeatHz}};
    if (const double hz = settings.own.number("telemetry_hz"); hz > 0.0) {
      use.feedback.push_back({odrive::canId(node, odrive::Message::kBusVoltage), FrameShape{}, hz});
      use.feedback.push_back(
          {odrive::canId(node, v06 ? odrive::Message::kTorques : odrive::Message::kIq), FrameShape{}, hz});
      if (v06) use.feedback.push_back({odrive::canId(node, odrive::Message::kTemperature), FrameShape{}, hz});
    }
    // Rest takes two short frames, more than the one long frame of a target. The others are rare or take
    // their place.
    const double command_hz = static_cast<double>(settings.tick_hz) / std::max(settings.command_divider, 1);
    constexpr FrameShape kShort{.length = 4};
    use.commands = {{odrive::canId(node, odrive::Message::kSetInputTorque), kShort, command_hz},
                    {odrive::canId(node, odrive::Message::kSetAxisState), kShort, command_hz},
                    {odrive::canId(node, odrive::Message::kSetControllerMode), FrameShape{}, 0.0},
                    {odrive::canId(node, odrive::Message::kSetInputPos), FrameShape{}, 0.0},
                    {odrive::canId(node, odrive::Message::kSetInputVel), FrameShape{}, 0.0},
                    {odrive::canId(node, odrive::Message::kSetLimits), FrameShape{}, kLimitsHz},
                    {odrive::canId(node, odrive::Message::kClearErrors), FrameShape{.length = 1}, 0.0}};
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    return registerSolo(std::make_unique<ODrive_Motor>(settings, traits(settings.model, settings.own)),
                        parts);
  }
};

}  // namespace

const MotorFamily& odriveFamily() noexcept {
  static const OdriveFamily kFamily;
  return kFamily;
}

}  // namespace rc10
