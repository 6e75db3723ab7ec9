// vedderb/bldc comm/comm_can.c: extended id = packet << 8 | controller, big endian.
#include <cmath>

#include "bus/can_frame.hpp"
#include "drives/vesc/vesc_model.hpp"
#include "faults/wire.hpp"

namespace rc10::test {
namespace {

constexpr double kPlaceStepDeg = 0.02;  // of STATUS_4

class VescWire final : public Wire {
 public:
  explicit VescWire(const MotorConfig& config) : Wire(config), options_(vescSettings(config.settings.own)) {
    const double gear = config.settings.gear_ratio > 0.0 ? config.settings.gear_ratio : 1.0;
    rpm_per_erpm_ = direction() / (options_.pole_pairs * gear);
    if (options_.angle == VescAngle::kEncoder) deg_per_deg_ = direction() * options_.position_divider / gear;
  }

  std::uint64_t said(const CanFrame& frame) override {
    if (!frame.id.extended || (frame.id.value & 0xFFU) != static_cast<std::uint32_t>(id())) return 0;
    const std::uint32_t packet = frame.id.value >> 8U;
    if (packet == 8) {  // a question: sender, 0, COMM_GET_VALUES_SELECTIVE, a mask
      if (!plainFrame(frame, 7) || frame.data[2] != 50) refuse(frame, "a command in a buffer");
      return kAllBytes;
    }
    // In frames of 6 bytes and more firmware >= 6.00 takes the first for something else.
    if (!plainFrame(frame, 4)) refuse(frame, "a command frame of another form");
    const auto raw = static_cast<double>(int32Of(bigEndian(frame, 0, 4)));
    const double share_a = raw * 1e-5 * static_cast<double>(options_.motor_current_max_a);
    told_ = {.effort_step = 1e-3, .velocity_step_rpm = std::fabs(rpm_per_erpm_)};
    if (packet >= 10) told_.effort_step = 1e-5 * static_cast<double>(options_.motor_current_max_a);
    switch (packet) {
      case 0: say(Told::Law::kDuty, direction() * raw * 1e-5); break;
      case 1: say(Told::Law::kEffort, direction() * raw * 1e-3); break;
      case 2:
      case 12: resist(raw * 1e-3); break;
      case 3:
        told_.law = Told::Law::kVelocity;
        told_.velocity_rpm = raw * rpm_per_erpm_;
        break;
      case 4:
        told_.law = Told::Law::kAngle;
        told_.led = true;
        told_.ahead_deg = std::remainder(raw * 1e-6 - place_deg_, 360.0) * deg_per_deg_;
        told_.ahead_step_deg = kPlaceStepDeg * std::fabs(deg_per_deg_);
        if (raw < 0.0 || raw > 360e6) refuse(frame, "a place beyond the circle");
        break;
      case 10: say(Told::Law::kEffort, direction() * share_a); break;
      case 11:
      case 13: resist(share_a); break;
      default: refuse(frame, "a packet that rc10d has no business with");
    }
    return kAllBytes;
  }

  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    if (!frame.id.extended || (frame.id.value & 0xFFU) != static_cast<std::uint32_t>(id())) return false;
    const std::uint32_t packet = frame.id.value >> 8U;
    const bool moves = packet <= 4 || (packet >= 10 && packet <= 13);
    return moves && frame.type == FrameType::kData && (packet != 1 || saysSomething(frame));
  }

  bool heard(const CanFrame& frame) override {
    if (!frame.id.extended || (frame.id.value & 0xFFU) != static_cast<std::uint32_t>(id())) return false;
    if (!plainFrame(frame, 8)) return false;
    switch (frame.id.value >> 8U) {
      case 9:
        measured_.velocity_rpm = int32Of(bigEndian(frame, 0, 4)) * rpm_per_erpm_;
        return options_.angle == VescAngle::kNone;
      case 16:
        place_deg_ = int16Of(bigEndian(frame, 6, 2)) * kPlaceStepDeg;
        measured_.temperature_c = int16Of(bigEndian(frame, options_.motor_temperature ? 2 : 0, 2)) * 0.1;
        return options_.angle == VescAngle::kEncoder;
      case 27: return options_.angle == VescAngle::kTachometer;
      default: return false;
    }
  }

  [[nodiscard]] Told told() const override { return told_; }

 private:
  void say(Told::Law law, double effort) {
    told_.law = law;
    told_.effort = effort;
  }
  void resist(double amperes) {
    told_.law = Told::Law::kBrake;
    told_.most_effort = amperes;
  }

  VescSettings options_;
  double rpm_per_erpm_ = 1.0;
  double deg_per_deg_ = 1.0;  // of the output shaft for each of its position
  double place_deg_ = 0.0;
  Told told_;
};

}  // namespace

std::unique_ptr<Wire> makeVescWire(const MotorConfig& config) { return std::make_unique<VescWire>(config); }

}  // namespace rc10::test
