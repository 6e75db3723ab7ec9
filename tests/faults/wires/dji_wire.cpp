// Four currents or voltages in one frame, int16, big endian: manuals of the C610, C620 and GM6020.
#include <cmath>

#include "bus/can_frame.hpp"
#include "drives/dji/dji_model.hpp"
#include "faults/wire.hpp"

namespace rc10::test {
namespace {

class DjiWire final : public Wire {
 public:
  explicit DjiWire(const MotorConfig& config) : Wire(config) {
    const MotorSettings& dji = config.settings;
    const DjiModel& model = *findDjiModel(dji.model);
    const DjiCommand command = djiSettings(dji.own).command;
    const auto& table = model.command(command);
    const double gear = dji.gear_ratio > 0.0 ? dji.gear_ratio : model.gear_ratio;
    command_id_ = {table.command_ids[dji.id > 4 ? 1 : 0], false};
    slot_ = static_cast<std::size_t>((dji.id - 1) % 4);
    feedback_id_ = {static_cast<std::uint32_t>(model.feedback_id_base + dji.id), false};
    raw_per_effort_ =
        dji.direction * static_cast<double>(table.raw_full_scale) / static_cast<double>(table.full_scale);
    rpm_per_raw_ = dji.direction / gear;
    if (command == DjiCommand::kCurrent) {
      damp_per_rpm_ = static_cast<double>(table.full_scale) * gear / model.gear_ratio /
                      static_cast<double>(model.no_load_rpm);
    }
    told_.effort_step = 1.0 / std::fabs(raw_per_effort_);
  }

  std::uint64_t said(const CanFrame& frame) override {
    if (frame.id != command_id_) return 0;
    if (!plainFrame(frame, 8)) refuse(frame, "a command frame of another form");
    told_.law = Told::Law::kEffort;
    told_.effort = int16Of(bigEndian(frame, 2 * slot_, 2)) / raw_per_effort_;
    return 3ULL << (2 * slot_);
  }

  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    return frame.id == command_id_ && plainFrame(frame, 8) && saysSomething(frame);
  }

  bool heard(const CanFrame& frame) override {
    if (!plainFrame(frame, 8) || frame.id != feedback_id_) return false;
    if (bigEndian(frame, 0, 2) >= 8192) return false;
    measured_.velocity_rpm = int16Of(bigEndian(frame, 2, 2)) * rpm_per_raw_;
    measured_.temperature_c = frame.data[6];
    return true;
  }

  [[nodiscard]] Told told() const override { return told_; }
  [[nodiscard]] bool samplesAlways() const override { return true; }
  [[nodiscard]] bool toldOnceATick() const override { return true; }
  [[nodiscard]] double dampPerRpm() const override { return damp_per_rpm_; }

 private:
  CanId command_id_;
  CanId feedback_id_;
  std::size_t slot_ = 0;
  double raw_per_effort_ = 1.0;
  double rpm_per_raw_ = 1.0;
  double damp_per_rpm_ = 0.0;  // a voltage damps nothing
  Told told_{.law = Told::Law::kEffort};
};

}  // namespace

std::unique_ptr<Wire> makeDjiWire(const MotorConfig& config) { return std::make_unique<DjiWire>(config); }

}  // namespace rc10::test
