#pragma once

#include <cstdint>

#include "app/time.hpp"

namespace rc10 {

/// Finds the end of an axis: first away from it, to see that the axis moves at all, then towards it until it
/// stands against the stop or the switch closes. All by a current that is bounded, so that the stop is met
/// gently: near the homing velocity the current goes to 0.
class JointHoming {
 public:
  enum class Way : std::uint8_t { kStop, kSwitch };
  struct Config {
    Way way = Way::kStop;
    double velocity_rpm = 0.0;  ///< Towards the end; its sign says where that is.
    double current_a = 0.0;     ///< The most that pushes.
    double away_deg = 0.0;      ///< So far it goes away first.
    Duration stopped{};         ///< Standing still for so long is the stop.
    Duration timeout{};
  };
  struct Measured {
    double total_angle_deg = 0.0;
    double velocity_rpm = 0.0;
    bool at_switch = false;
    bool switch_heard = true;  ///< Else the end would be run over.
    MonotonicTime now;
  };
  enum class Progress : std::uint8_t { kUnderWay, kFound, kFailed };

  explicit JointHoming(const Config& config) noexcept : config_(config) {}

  void start(const Measured& measured) noexcept;
  [[nodiscard]] Progress step(const Measured& measured) noexcept;
  /// Current for the motor, A.
  [[nodiscard]] double current() const noexcept { return current_a_; }

 private:
  void push(double velocity_rpm, double measured_rpm) noexcept;
  [[nodiscard]] bool standsStill(const Measured& measured) noexcept;

  enum class Phase : std::uint8_t { kAway, kTowards };

  Config config_;
  Phase phase_ = Phase::kAway;
  double start_deg_ = 0.0;
  MonotonicTime started_{};
  MonotonicTime moved_{};
  double current_a_ = 0.0;
};

}  // namespace rc10
