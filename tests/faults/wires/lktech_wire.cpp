// LK-TECH's CAN protocol V2.3: 0x140 + id both ways, little endian; 0x280: four currents in one frame.
#include <cmath>

#include "bus/can_frame.hpp"
#include "drives/lktech/lktech_model.hpp"
#include "faults/wire.hpp"

namespace rc10::test {
namespace {

class LktechWire final : public Wire {
 public:
  explicit LktechWire(const MotorConfig& config)
      : Wire(config),
        own_id_{0x140U + static_cast<std::uint32_t>(config.settings.id), false},
        grouped_(config.settings.own.flag("group")),
        a_per_raw_(findLktechModel(config.settings.model)->amperes_per_raw) {}

  std::uint64_t said(const CanFrame& frame) override {
    const bool to_all = grouped_ && frame.id == CanId{0x280, false};
    if (!to_all && frame.id != own_id_) return 0;
    if (!plainFrame(frame, 8)) refuse(frame, "a command frame of another form");
    if (!to_all) {
      saidAlone(frame);
      return kAllBytes;
    }
    const auto slot = static_cast<std::size_t>(id() - 1);
    say(int16Of(littleEndian(frame, 2 * slot, 2)));
    return 3ULL << (2 * slot);
  }

  bool heard(const CanFrame& frame) override {
    if (frame.id != own_id_ || !plainFrame(frame, 8)) return false;
    switch (frame.data[0]) {
      case 0x9C:
      case 0xA1:
      case 0xA2:
      case 0xA4:
        measured_.temperature_c = static_cast<std::int8_t>(frame.data[1]);
        measured_.velocity_rpm = int16Of(littleEndian(frame, 4, 2)) / traits().gear_ratio / 6.0 / perOutput();
        return true;
      case 0x9A:
      case 0x9B: measured_.temperature_c = static_cast<std::int8_t>(frame.data[1]); return false;
      default: return false;
    }
  }

  [[nodiscard]] Told told() const override { return told_; }

 private:
  void say(int raw) {
    told_ = {.law = Told::Law::kEffort,
             .effort = direction() * raw * a_per_raw_,
             .effort_step = 0.5 * a_per_raw_,
             .velocity_step_rpm = 0.01 / traits().gear_ratio / 6.0};
  }

  void saidAlone(const CanFrame& frame) {
    const auto low = static_cast<double>(int16Of(littleEndian(frame, 2, 2)));
    const auto number = static_cast<double>(int32Of(littleEndian(frame, 4, 4)));
    const double gear = traits().gear_ratio;
    switch (frame.data[0]) {
      case 0x80: told_ = {}; return;
      case 0x81: told_ = {.law = Told::Law::kVelocity}; return;
      case 0x88:  // on
      case 0x92:  // questions, and the end of an error
      case 0x9A:
      case 0x9B:
      case 0x9C: return;
      case 0xA1:
        if (grouped_) refuse(frame, "a current of its own, of a motor of a group");
        say(int16Of(littleEndian(frame, 4, 2)));
        return;
      case 0xA2:
        say(0);
        told_.law = Told::Law::kVelocity;
        told_.velocity_rpm = number * 0.01 / gear / 6.0 / perOutput();
        told_.most_effort = low * a_per_raw_;
        return;
      case 0xA4:
        say(0);
        told_.law = Told::Law::kAngle;
        told_.most_rpm = static_cast<double>(littleEndian(frame, 2, 2)) / gear / 6.0 / std::fabs(perOutput());
        return;
      default: refuse(frame, "its zero, its settings, or nothing known");
    }
  }

  CanId own_id_;
  bool grouped_;
  double a_per_raw_;
  Told told_;
};

}  // namespace

std::unique_ptr<Wire> makeLktechWire(const MotorConfig& config) {
  return std::make_unique<LktechWire>(config);
}

}  // namespace rc10::test
