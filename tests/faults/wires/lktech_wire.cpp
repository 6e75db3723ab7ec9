// LK-TECH's CAN protocol V2.3: 0x140 + id both ways, little endian; 0x280: four currents in one frame.
#include <chrono>
#include <cmath>
#include <utility>

#include "bus/can_frame.hpp"
#include "drives/lktech/lktech_model.hpp"
#include "faults/wire.hpp"

namespace rc10::test {
namespace {

constexpr double kFarFromZeroC = 3.0;
// Its turns are followed from sample to sample for so long, until it tells them anew.
constexpr Duration kFollowed = std::chrono::milliseconds{90};
// Its turns and its encoder may differ by this.
constexpr double kSamePlaceDeg = 0.02;

class LktechWire final : public Wire {
 public:
  explicit LktechWire(const MotorConfig& config)
      : Wire(config),
        own_id_{0x140U + static_cast<std::uint32_t>(config.settings.id), false},
        grouped_(config.settings.own.flag("group")),
        a_per_raw_(findLktechModel(config.settings.model)->amperes_per_raw),
        counts_(std::ldexp(1.0, config.settings.own.integer("encoder_bits"))) {}

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

  // Its answers have the id of its commands, and its temperature where those have a zero.
  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    if (!plainFrame(frame, 8)) return false;
    if (frame.id == CanId{0x280, false}) return id() <= 4 && saysSomething(frame);
    const bool warm = measured_.temperature_c > kFarFromZeroC;
    if (frame.id != own_id_ || !warm || frame.data[1] != 0) return false;
    if (frame.data[0] == 0xA2 || frame.data[0] == 0xA4) return true;
    const bool current = frame.data[0] == 0xA1 && littleEndian(frame, 2, 2) == 0;
    return current && littleEndian(frame, 6, 2) == 0 && littleEndian(frame, 4, 2) != 0;
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
        heardPlace(frame);
        return true;
      case 0x92: heardTurns(frame); return false;
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

  // Within a turn of the drive's output, as it turned since the last.
  void heardPlace(const CanFrame& frame) {
    const double here_deg = std::fmod(littleEndian(frame, 6, 2), counts_) * 360.0 / counts_;
    const auto gap = frame.received - std::exchange(heard_at_, frame.received);
    const double rpm = measured_.velocity_rpm * perOutput();
    const double mean_deg_s = 3.0 * (rpm + std::exchange(rpm_, rpm));
    const bool follows = gap <= kFollowed;
    counted_ = counted_ && follows;
    const double way_deg = follows ? mean_deg_s * static_cast<double>(seconds(gap)) : 0.0;
    const double expected_deg = place_deg_ + way_deg;
    place_deg_ = expected_deg + std::remainder(here_deg - expected_deg, 360.0);
    placed_ = true;
  }

  // Angle of the rotor, of all turns: its turn, at the place within it that is known better.
  void heardTurns(const CanFrame& frame) {
    const auto low = static_cast<std::uint64_t>(littleEndian(frame, 1, 4));
    const auto high = static_cast<std::uint64_t>(littleEndian(frame, 5, 3));
    const auto raw = static_cast<std::int64_t>((high << 32U | low) << 8U) / 256;
    const double angle_deg = static_cast<double>(raw) * 0.01 / traits().gear_ratio;
    // A copy of the question is no answer.
    if (!placed_ || raw == 0) return;
    place_deg_ = angle_deg + std::remainder(place_deg_ - angle_deg, 360.0);
    counted_ = true;
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
        if (counted_) told_.ahead_deg = (number * 0.01 / gear - place_deg_) / perOutput();
        told_.ahead_step_deg = (360.0 / counts_ + kSamePlaceDeg) / std::fabs(perOutput());
        told_.most_rpm = static_cast<double>(littleEndian(frame, 2, 2)) / gear / 6.0 / std::fabs(perOutput());
        return;
      default: refuse(frame, "its zero, its settings, or nothing known");
    }
  }

  CanId own_id_;
  bool grouped_;
  double a_per_raw_;
  double counts_;  // of its encoder
  double place_deg_ = 0.0;
  double rpm_ = 0.0;  // of the drive
  MonotonicTime heard_at_{};
  bool placed_ = false;
  bool counted_ = false;  // its place is that of all turns
  Told told_;
};

}  // namespace

std::unique_ptr<Wire> makeLktechWire(const MotorConfig& config) {
  return std::make_unique<LktechWire>(config);
}

}  // namespace rc10::test
