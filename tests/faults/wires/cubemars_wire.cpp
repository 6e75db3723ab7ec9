// CubeMars AK series module driver manual V1.0.8, 5.1 to 5.3; V3: cubemars_driver_node.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "bus/can_frame.hpp"
#include "drives/cubemars/cubemars_model.hpp"
#include "faults/wire.hpp"
#include "faults/wrapped_reading.hpp"

namespace rc10::test {
namespace {

constexpr std::uint32_t kServoReport = 0x29;
constexpr double kCubeMarsStiffnessMax = 500.0;
constexpr double kCubeMarsDampingMax = 5.0;

class CubemarsWire final : public Wire {
 public:
  explicit CubemarsWire(const MotorConfig& config)
      : Wire(config),
        setup_(cubemarsSettings(config.settings.model, config.settings.own)),
        reading_(2.0 * setup_.ranges.position_rad, setup_.ranges.velocity_rad_s,
                 std::max(setup_.ranges.velocity_rad_s,
                          cubemarsFastestRpm(*setup_.model) * std::numbers::pi / 30.0)) {
    own_id_ = static_cast<std::uint32_t>(id());
    mit_ = setup_.protocol == CubemarsProtocol::kMit;
    speed_field_end_rad_s_ = mit_ ? setup_.ranges.velocity_rad_s : 0.0;
    // Scaled without limits: float_to_uint() of the Mini Cheetah's firmware.
    if (mit_)
      measured_.velocity_wrap_rpm =
          std::fabs(rpmOfRadPerS(setup_.ranges.velocity_rad_s)) * 2.0 * 4096.0 / 4095.0;
  }

  std::uint64_t said(const CanFrame& frame) override {
    if (frame.id.extended == mit_ || (frame.id.value & 0xFFU) != own_id_) return 0;
    if (mit_ && frame.id.value != own_id_) return 0;
    if (frame.type != FrameType::kData || frame.fd) refuse(frame, "a command frame of another form");
    if (mit_) {
      saidMit(frame);
    } else {
      saidServo(frame);
    }
    return kAllBytes;
  }

  // Frames on the id of a MIT drive that begin with it are its answers.
  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    if (frame.type != FrameType::kData || frame.fd || frame.id.extended == mit_) return false;
    if (mit_) {
      return frame.id.value == own_id_ && frame.length == 8 && frame.data[0] != own_id_ && !isOrder(frame) &&
             lawOfTorque(frame, 28, 40, 52);
    }
    const std::uint32_t command = frame.id.value >> 8U;
    if ((frame.id.value & 0xFFU) != own_id_) return false;
    if (command == 8) return frame.length == 8 && lawOfTorque(frame, 0, 12, 52);
    const bool moves = command <= 4 || command == 6;
    return moves && saysSomething(frame);
  }

  bool heard(const CanFrame& frame) override { return mit_ ? heardMit(frame) : heardServo(frame); }

  [[nodiscard]] Told told() const override {
    Told told = told_;
    if (!on_) told.law = Told::Law::kOff;
    return told;
  }

 private:
  [[nodiscard]] static bool isOrder(const CanFrame& frame) {
    return std::all_of(frame.data.begin(), frame.data.begin() + 7,
                       [](std::uint8_t byte) { return byte == 0xFF; });
  }

  void saidServo(const CanFrame& frame) {
    const auto raw = static_cast<double>(int32Of(bigEndian(frame, 0, 4)));
    const std::uint32_t command = frame.id.value >> 8U;
    if (command != 8) {
      const bool two_more = command == 6;
      if (frame.length != (two_more ? 8 : 4)) refuse(frame, "a command frame of another length");
    }
    told_ = {.effort_step = 1e-3, .velocity_step_rpm = std::fabs(rpmOfErpm(1.0))};
    on_ = true;
    switch (command) {
      case 0:
        told_.law = Told::Law::kDuty;
        told_.effort = direction() * raw * 1e-5;
        return;
      case 1:
        told_.law = Told::Law::kEffort;
        told_.effort = direction() * raw * 1e-3;
        return;
      case 2:
        told_.law = Told::Law::kBrake;
        told_.most_effort = raw * 1e-3;
        return;
      case 3:
        told_.law = Told::Law::kVelocity;
        told_.velocity_rpm = rpmOfErpm(raw);
        return;
      case 6: told_.most_rpm = std::fabs(rpmOfErpm(10.0 * int16Of(bigEndian(frame, 4, 2)))); [[fallthrough]];
      case 4:
        told_.law = Told::Law::kAngle;
        told_.ahead_deg = (raw * 1e-4 - message_deg_) / setup_.message_deg_per_deg / perOutput();
        told_.ahead_step_deg = 1e-4;
        return;
      case 8: return saidLaw(frame, {24, 16}, {40, 12}, {0, 12}, {12, 12}, {52, 12});
      default: refuse(frame, "it makes where it stands its origin, or nothing known");
    }
  }

  void saidMit(const CanFrame& frame) {
    if (frame.length != 8) refuse(frame, "a command frame of another length");
    const bool order = isOrder(frame);
    if (order && frame.data[7] == 0xFE) refuse(frame, "it makes where it stands its zero");
    if (order && (frame.data[7] == 0xFC || frame.data[7] == 0xFD)) {
      on_ = frame.data[7] == 0xFC;
      return;
    }
    // Outside of the mode no law is taken in, and the last one acts again in it.
    if (on_) saidLaw(frame, {0, 16}, {16, 12}, {28, 12}, {40, 12}, {52, 12});
  }

  struct Field {
    std::size_t first;
    std::size_t bits;
  };
  void saidLaw(const CanFrame& frame, Field position, Field velocity, Field stiffness, Field damping,
               Field torque) {
    const auto& range = setup_.ranges;
    const auto field = [&frame](Field which, double low, double high) {
      return onScale(bitsAt(frame, which.first, which.bits), low, high, static_cast<unsigned>(which.bits));
    };
    told_ = springOf({.position_rad = field(position, -range.position_rad, range.position_rad),
                      .velocity_rad_s = field(velocity, -range.velocity_rad_s, range.velocity_rad_s),
                      .stiffness = field(stiffness, 0.0, kCubeMarsStiffnessMax),
                      .damping = field(damping, 0.0, kCubeMarsDampingMax),
                      .torque_nm = field(torque, -range.torque_nm, range.torque_nm)},
                     {.position_rad = 2.0 * range.position_rad / 65535.0,
                      .velocity_rad_s = 2.0 * range.velocity_rad_s / 4095.0,
                      .stiffness = kCubeMarsStiffnessMax / 4095.0,
                      .damping = kCubeMarsDampingMax / 4095.0,
                      .torque_nm = 2.0 * range.torque_nm / 4095.0},
                     position_rad_, velocity_rad_s_);
  }

  bool heardServo(const CanFrame& frame) {
    if (frame.id != CanId{kServoReport << 8U | own_id_, true} || !plainFrame(frame, 8)) return false;
    message_deg_ = 0.1 * int16Of(bigEndian(frame, 0, 2));
    position_rad_ = message_deg_ / setup_.message_deg_per_deg * std::numbers::pi / 180.0;
    measured_.velocity_rpm = rpmOfErpm(10.0 * int16Of(bigEndian(frame, 2, 2)));
    velocity_rad_s_ = measured_.velocity_rpm * perOutput() * 2.0 * std::numbers::pi / 60.0;
    measured_.temperature_c = static_cast<std::int8_t>(frame.data[6]);
    return true;
  }

  bool heardMit(const CanFrame& frame) {
    const bool from_it = frame.id == CanId{0, false} || frame.id == CanId{own_id_, false};
    if (!from_it || frame.type != FrameType::kData || frame.fd || frame.data[0] != own_id_) return false;
    if (frame.length != 8 && frame.length != 6) return false;
    const auto& range = setup_.ranges;
    position_rad_ = onScale(bitsAt(frame, 8, 16), -range.position_rad, range.position_rad, 16);
    const double told_rad_s = onScale(bitsAt(frame, 24, 12), -range.velocity_rad_s, range.velocity_rad_s, 12);
    velocity_rad_s_ = reading_.take(told_rad_s, position_rad_, frame.received);
    measured_.velocity_rpm = rpmOfRadPerS(velocity_rad_s_);
    if (frame.length == 8) measured_.temperature_c = frame.data[6] - 40.0;
    return true;
  }

  [[nodiscard]] double rpmOfErpm(double erpm) const {
    return erpm / (setup_.model->gear_ratio * std::max(setup_.pole_pairs, 1)) / perOutput();
  }

  CubemarsSettings setup_;
  WrappedReading reading_;
  std::uint32_t own_id_ = 0;
  bool mit_ = false;
  bool on_ = false;
  double message_deg_ = 0.0;
  double position_rad_ = 0.0;
  double velocity_rad_s_ = 0.0;
  Told told_;
};

}  // namespace

std::unique_ptr<Wire> makeCubemarsWire(const MotorConfig& config) {
  return std::make_unique<CubemarsWire>(config);
}

}  // namespace rc10::test
