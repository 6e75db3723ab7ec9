// DM-J manuals of 2026 (J4310 V1.2), "CAN Communication". Codes are rounded down.
#include <algorithm>
#include <cmath>

#include "bus/can_frame.hpp"
#include "drives/damiao/damiao_family.hpp"
#include "faults/wire.hpp"
#include "faults/wrapped_reading.hpp"

namespace rc10::test {
namespace {

constexpr std::uint32_t kRegisters = 0x7FF;
constexpr std::uint8_t kRead = 0x33;
constexpr std::uint8_t kWrite = 0x55;
constexpr std::uint8_t kSave = 0xAA;
constexpr std::uint8_t kTimeoutRegister = 9;
constexpr std::uint8_t kControlRegister = 10;
constexpr std::uint8_t kLastRegister = 81;
constexpr double kStepsPerMs = 20.0;  // of the timeout: 50 us
constexpr double kDamiaoStiffnessMax = 500.0;
constexpr double kDamiaoDampingMax = 5.0;

class DamiaoWire final : public Wire {
 public:
  explicit DamiaoWire(const MotorConfig& config)
      : Wire(config),
        own_(damiaoSettings(config.settings)),
        mode_(static_cast<unsigned>(own_.control)),
        watchdog_steps_(static_cast<std::uint32_t>(
            std::max(1.0, std::round(config.settings.own.number("watchdog_ms") * kStepsPerMs)))),
        reading_(2.0 * own_.scale.p_max_rad * 65536.0 / 65535.0, own_.scale.v_max_rad_s,
                 damiaoFastestRadS(*findDamiaoModel(config.settings.model), own_.scale)) {
    measured_.velocity_step_rpm = std::fabs(rpmOfRadPerS(own_.scale.v_max_rad_s)) * 2.0 / 4095.0;
    measured_.velocity_wrap_rpm = 4096.0 * measured_.velocity_step_rpm;
    command_id_ = {(mode_ - 1U) * 0x100U + static_cast<std::uint32_t>(id()), false};
  }

  std::uint64_t said(const CanFrame& frame) override {
    if (frame.id == CanId{kRegisters, false}) return saidOfRegister(frame);
    if (frame.id != command_id_) return 0;
    if (frame.type != FrameType::kData || frame.fd != own_.can_fd)
      refuse(frame, "a command frame of another form");
    if (frame.length == 8 && isSpecial(frame)) {
      saidSpecial(frame);
    } else {
      saidCommand(frame);
    }
    return kAllBytes;
  }

  // In each of its modes.
  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    const bool command = !frame.id.extended && frame.id.value < 0x400 && frame.type == FrameType::kData &&
                         (frame.id.value & 0xFFU) == static_cast<std::uint32_t>(id());
    return command && !(frame.length == 8 && isSpecial(frame));
  }

  bool heard(const CanFrame& frame) override {
    if (frame.type != FrameType::kData || frame.fd != own_.can_fd || frame.length != 8) return false;
    if (frame.id != CanId{own_.master_id, false} || (frame.data[0] & 0x0FU) != static_cast<unsigned>(id()))
      return false;
    const bool of_register = frame.data[0] == id() && frame.data[1] == 0 && frame.data[3] <= kLastRegister &&
                             (frame.data[2] == kRead || frame.data[2] == kWrite || frame.data[2] == kSave);
    if (of_register) return false;
    if (frame.data[0] >> 4U != 1U) told_.law = Told::Law::kOff;  // it is not enabled
    position_rad_ = onScale(bitsAt(frame, 8, 16), -own_.scale.p_max_rad, own_.scale.p_max_rad, 16);
    const double told_rad_s =
        onScale(bitsAt(frame, 24, 12), -own_.scale.v_max_rad_s, own_.scale.v_max_rad_s, 12);
    velocity_rad_s_ = reading_.take(told_rad_s, position_rad_, frame.received);
    measured_.velocity_rpm = rpmOfRadPerS(velocity_rad_s_);
    const auto celsius = [](std::uint8_t byte) {
      return static_cast<double>(static_cast<std::int8_t>(byte));
    };
    measured_.temperature_c = std::max(celsius(frame.data[6]), celsius(frame.data[7]));
    return true;
  }

  [[nodiscard]] Told told() const override { return told_; }
  [[nodiscard]] bool idlesAtRest() const override { return mode_ == 1; }
  // Command of another of its modes.
  [[nodiscard]] bool obeys(const CanFrame& frame) const override {
    return !frame.id.extended && frame.id.value < 0x400 &&
           (frame.id.value & 0xFFU) == static_cast<std::uint32_t>(id());
  }

 private:
  [[nodiscard]] static bool isSpecial(const CanFrame& frame) {
    const auto seven = std::all_of(frame.data.begin(), frame.data.begin() + 7,
                                   [](std::uint8_t byte) { return byte == 0xFF; });
    return seven && frame.data[7] >= 0xFB;
  }

  std::uint64_t saidOfRegister(const CanFrame& frame) {
    if (littleEndian(frame, 0, 2) != static_cast<std::uint32_t>(id())) return 0;
    if (frame.length != 8 || frame.fd != own_.can_fd) refuse(frame, "a frame of a register of another form");
    if (frame.data[2] == kRead) return kAllBytes;
    if (frame.data[2] != kWrite) refuse(frame, "settings are stored");
    const std::uint32_t value = littleEndian(frame, 4, 4);
    switch (frame.data[3]) {
      case kTimeoutRegister:
        if (value != watchdog_steps_) refuse(frame, "another watchdog than its own");
        watchdog_told_ = true;
        break;
      case kControlRegister:
        if (value != mode_) refuse(frame, "another mode than its own");
        mode_told_ = true;
        break;
      default: refuse(frame, "a setting that rc10d has no business with");
    }
    return kAllBytes;
  }

  void saidSpecial(const CanFrame& frame) {
    switch (frame.data[7]) {
      case 0xFC:
        if (!watchdog_told_ || !mode_told_) refuse(frame, "enabled without its watchdog and its mode");
        if (told_.law == Told::Law::kOff) told_ = {.law = Told::Law::kEffort, .effort_step = torqueStep()};
        return;
      case 0xFB:
      case 0xFD: told_ = {}; return;
      default: refuse(frame, "it makes where it stands its zero, and stores that");
    }
  }

  void saidCommand(const CanFrame& frame) {
    // Only an enabled drive listens; a command never enables it.
    if (told_.law == Told::Law::kOff) return;
    told_ = {.effort_step = torqueStep(),
             .velocity_step_rpm = std::fabs(rpmOfRadPerS(own_.scale.v_max_rad_s)) * 2.0 / 4095.0};
    switch (mode_) {
      case 1: return saidMit(frame);
      case 2: {
        const double limit_rad_s = static_cast<double>(floatOf(littleEndian(frame, 4, 4)));
        return saidPosition(static_cast<double>(floatOf(littleEndian(frame, 0, 4))), limit_rad_s, 1.0);
      }
      case 3:
        told_.law = Told::Law::kVelocity;
        told_.velocity_rpm = rpmOfRadPerS(static_cast<double>(floatOf(littleEndian(frame, 0, 4))));
        return;
      default: {
        const double limit_rad_s = littleEndian(frame, 4, 2) * 0.01;
        return saidPosition(static_cast<double>(floatOf(littleEndian(frame, 0, 4))), limit_rad_s,
                            littleEndian(frame, 6, 2) * 1e-4);
      }
    }
  }

  void saidMit(const CanFrame& frame) {
    const auto& scale = own_.scale;
    told_ =
        springOf({.position_rad = onScale(bitsAt(frame, 0, 16), -scale.p_max_rad, scale.p_max_rad, 16),
                  .velocity_rad_s = onScale(bitsAt(frame, 16, 12), -scale.v_max_rad_s, scale.v_max_rad_s, 12),
                  .stiffness = onScale(bitsAt(frame, 28, 12), 0.0, kDamiaoStiffnessMax, 12),
                  .damping = onScale(bitsAt(frame, 40, 12), 0.0, kDamiaoDampingMax, 12),
                  .torque_nm = onScale(bitsAt(frame, 52, 12), -scale.t_max_nm, scale.t_max_nm, 12)},
                 {.position_rad = 2.0 * scale.p_max_rad / 65535.0,
                  .velocity_rad_s = 2.0 * scale.v_max_rad_s / 4095.0,
                  .stiffness = kDamiaoStiffnessMax / 4095.0,
                  .damping = kDamiaoDampingMax / 4095.0,
                  .torque_nm = 2.0 * scale.t_max_nm / 4095.0},
                 position_rad_, velocity_rad_s_);
  }

  // Its position field wraps, the one of the command does not.
  void saidPosition(double rad, double limit_rad_s, double share) {
    const double scale_rad = 2.0 * own_.scale.p_max_rad;
    told_.ahead_deg = degOfRad(std::remainder(rad - position_rad_, scale_rad));
    // Each time round a step more: its ends are one place and two codes.
    const double rounds = std::fabs(rad) / scale_rad;
    told_.ahead_step_deg = std::fabs(degOfRad((1.0 + rounds) * scale_rad / 65535.0 + 1e-6 * std::fabs(rad)));
    told_.ahead_turn_deg = std::fabs(degOfRad(scale_rad));
    told_.law = limit_rad_s > 0.0 ? Told::Law::kAngle : Told::Law::kVelocity;
    told_.most_rpm = std::fabs(rpmOfRadPerS(limit_rad_s));
    told_.most_effort = share * static_cast<double>(traits().effort_full_scale);
  }

  [[nodiscard]] double torqueStep() const {
    return std::fabs(effortOfNm(own_.scale.t_max_nm)) * 2.0 / 4095.0;
  }

  DamiaoSettings own_;
  unsigned mode_;
  std::uint32_t watchdog_steps_;
  bool watchdog_told_ = false;
  bool mode_told_ = false;
  WrappedReading reading_;
  CanId command_id_;
  double position_rad_ = 0.0;
  double velocity_rad_s_ = 0.0;
  Told told_;
};

}  // namespace

std::unique_ptr<Wire> makeDamiaoWire(const MotorConfig& config) {
  return std::make_unique<DamiaoWire>(config);
}

}  // namespace rc10::test
