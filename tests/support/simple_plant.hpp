#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <numbers>
#include <utility>

#include "drives/dji/dji_motor.hpp"
#include "support/dji_frames.hpp"

namespace rc10::test {

/// An inertia with friction on a DJI motor, in SI units at the output shaft.
struct SimplePlant {
  double inertia_kg_m2 = 0.004;
  double coulomb_nm = 0.05;
  double viscous_nms = 0.0005;
  double load_nm = 0.0;  ///< Constant, against positive motion.
  double kt_nm_per_a = 0.3;
  double resistance_ohm = 0.2;
  double ke_v_s = 0.475;  ///< Back-EMF at the output: 24 V at the no-load speed.
  double supply_v = 24.0;

  double angle_rad = 0.0;
  double velocity_rad_s = 0.0;
  double current_a = 0.0;

  [[nodiscard]] double rpm() const { return velocity_rad_s * 30.0 / std::numbers::pi; }
  [[nodiscard]] double degrees() const { return angle_rad * 180.0 / std::numbers::pi; }

  void step(double effort, bool voltage, double dt_s) {
    const double emf = ke_v_s * velocity_rad_s;
    const double highest = (supply_v - emf) / resistance_ohm;
    const double lowest = (-supply_v - emf) / resistance_ohm;
    current_a = std::clamp(voltage ? (effort - emf) / resistance_ohm : effort, lowest, highest);
    const double drive = kt_nm_per_a * current_a - load_nm - viscous_nms * velocity_rad_s;
    const double before = velocity_rad_s;
    velocity_rad_s += drive / inertia_kg_m2 * dt_s;
    const double friction = coulomb_nm / inertia_kg_m2 * dt_s;  // stops, never reverses
    velocity_rad_s -= std::clamp(velocity_rad_s, -friction, friction);
    angle_rad += 0.5 * (before + velocity_rad_s) * dt_s;
  }
};

/// A wheel-sized load on the given model.
inline SimplePlant plantOf(const DjiModel& model) {
  SimplePlant plant;
  plant.kt_nm_per_a = static_cast<double>(model.rotor_torque_nm_per_a) * model.gear_ratio;
  plant.ke_v_s = 24.0 / (static_cast<double>(model.no_load_rpm) * std::numbers::pi / 30.0);
  if (model.name == "M2006") {
    plant.inertia_kg_m2 = 0.003;
    plant.resistance_ohm = 0.46;
  } else if (model.name == "GM6020") {
    plant.inertia_kg_m2 = 0.005;
    plant.resistance_ohm = 1.8;
    plant.coulomb_nm = 0.03;
  }
  return plant;
}

/// One motor object, its group and a plant, in virtual time. Feedback beats against the tick, is
/// quantised as the drive does it and late; commands act late. Total delay about 2.5 ms.
class DjiBench {
 public:
  static constexpr Duration kStep = std::chrono::microseconds{50};
  static constexpr Duration kTick = std::chrono::milliseconds{1};
  static constexpr Duration kFeedbackDelay = std::chrono::microseconds{250};
  static constexpr Duration kCommandDelay = std::chrono::microseconds{300};
  static constexpr double kSpeedFilter_s = 0.001;

  DjiBench(DJI_Motor& motor, SimplePlant plant) : motor_(motor), plant_(plant) {}

  SimplePlant& plant() { return plant_; }
  DJI_Motor& motor() { return motor_; }
  [[nodiscard]] MonotonicTime now() const { return now_; }
  void setFeedbackPeriod(Duration period) { feedback_period_ = period; }
  void stopFeedback(bool stop) { silent_ = stop; }

  /// Runs for `duration`; `each_tick` is called after every update.
  void run(Duration duration, const std::function<void()>& each_tick = {}) {
    for (const MonotonicTime end = now_ + duration; now_ < end; now_ += kStep) {
      if (now_ >= next_feedback_) sample();
      if (now_ >= next_tick_) {
        tick();
        if (each_tick) each_tick();
      }
      while (!commands_.empty() && commands_.front().first <= now_) {
        command_ = commands_.front().second;
        commands_.pop_front();
      }
      const double dt_s = static_cast<double>(seconds(kStep));
      plant_.step(command_, motor_.command() == DjiCommand::kVoltage, dt_s);
      reported_rad_s_ += (plant_.velocity_rad_s - reported_rad_s_) * dt_s / (kSpeedFilter_s + dt_s);
    }
  }

 private:
  void sample() {
    next_feedback_ += feedback_period_;
    if (silent_) return;
    const double gear = motor_.get_GearRatio();
    const double turns = plant_.angle_rad / (2.0 * std::numbers::pi) * gear;
    const double rotor_rpm = reported_rad_s_ * 30.0 / std::numbers::pi * gear;
    const DjiModel& model = motor_.model();
    DjiReport report;
    report.position =
        static_cast<std::uint16_t>(static_cast<std::int64_t>((turns - std::floor(turns)) * 8192.0) % 8192);
    report.rpm = static_cast<std::int16_t>(std::lround(std::clamp(rotor_rpm, -32767.0, 32767.0)));
    report.current = static_cast<std::int16_t>(std::lround(std::clamp(
        plant_.current_a * model.feedback_raw_full_scale / static_cast<double>(model.feedback_full_scale_a),
        -32767.0, 32767.0)));
    frames_.push_back(makeDjiFeedback(model, motor_.driveId(), report, now_ + kFeedbackDelay));
  }

  void tick() {
    next_tick_ += kTick;
    while (!frames_.empty() && frames_.front().received <= now_) {
      (void)motor_.updateFeedback(frames_.front());
      frames_.pop_front();
    }
    motor_.update(Tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F});
    const DjiCommandTable& table = motor_.model().command(motor_.command());
    const double effort = motor_.rawCommand() * static_cast<double>(table.full_scale) / table.raw_full_scale;
    commands_.emplace_back(now_ + kCommandDelay, effort);
  }

  DJI_Motor& motor_;
  SimplePlant plant_;
  MonotonicTime now_{std::chrono::seconds{100}};
  MonotonicTime next_tick_ = now_;
  MonotonicTime next_feedback_ = now_ + std::chrono::microseconds{150};
  Duration feedback_period_ = std::chrono::nanoseconds{1'000'300};  // the drive's own crystal
  std::uint64_t ticks_ = 0;
  bool silent_ = false;
  double command_ = 0.0;
  double reported_rad_s_ = 0.0;
  std::deque<CanFrame> frames_;
  std::deque<std::pair<MonotonicTime, double>> commands_;
};

}  // namespace rc10::test
