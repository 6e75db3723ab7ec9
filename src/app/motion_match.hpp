#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace rc10 {

/// Compares a sensor on a shaft with the motor that turns it: whether both move the same way, and how late
/// the sensor is. Other motion (a vehicle that turns, a shove) resembles neither and teaches nothing. The lag
/// is that of a new value: transmission and filter of the sensor, less those of the motor's feedback. Both
/// signals are angles, or both are rates.
class MotionMatch {
 public:
  enum class Sign { kUnknown, kAgrees, kOpposed };

  struct Config {
    double enough = 1.0;  ///< Integral over time of the motor's squared change before a judgement, unit^2 s.
    double circular_period = 0.0;  ///< Period of angles; 0: the signals do not wrap.
  };

  explicit MotionMatch(const Config& config) noexcept : config_(config) {}

  /// Once a tick, of even ticks; the sensor's last value stays until there is another. NaN: a gap.
  void step(double motor, double sensor, float dt_s) noexcept;
  /// The sensor's value of the last step was a new one.
  [[nodiscard]] bool fresh() const noexcept { return fresh_; }
  /// Stays until reset(). That of a sensor which was away for 2 s is found anew, unless it is opposed.
  [[nodiscard]] Sign sign() const noexcept { return sign_; }
  /// Empty until a motion has shown it.
  [[nodiscard]] std::optional<double> lagSeconds() const noexcept;
  /// The motor's signal when the sensor's value was true; the latest until the lag is known. NaN after a gap
  /// that is not longer ago than the lag.
  [[nodiscard]] double motorThen() const noexcept;
  /// Forgets what was learned.
  void reset() noexcept;

 private:
  static constexpr std::size_t kRoom = 256;  ///< Ticks; a power of two.
  static constexpr std::size_t kLags = 81;   ///< Candidates, a tick apart.

  struct Moment {
    double motor = 0.0;
    double sensor = 0.0;
    bool fresh = false;
  };
  /// Sums over changes of the recent past, for one candidate.
  struct Candidate {
    double energy = 0.0;    ///< Energy of the motor's changes.
    double same = 0.0;      ///< Energy of the sensor's less the motor's.
    double opposite = 0.0;  ///< Energy of the sensor's plus the motor's.
  };

  [[nodiscard]] const Moment& ago(std::size_t ticks) const noexcept {
    return ticks_[(newest_ + kRoom - ticks) % kRoom];
  }
  [[nodiscard]] double change(double from, double to) const noexcept;
  [[nodiscard]] std::size_t ticksOf(double duration_s, std::size_t most) const noexcept;
  void learn(double elapsed_s) noexcept;
  void judge(std::size_t candidates) noexcept;

  Config config_;
  std::array<Moment, kRoom> ticks_{};
  std::array<Candidate, kLags> candidates_{};
  std::size_t newest_ = 0;
  std::size_t count_ = 0;  ///< Ticks since the last gap, at most kRoom.
  double period_s_ = 0.0;
  double since_fresh_s_ = 0.0;
  double gap_s_ = 0.0;
  int learned_ = 0;
  bool fresh_ = false;
  Sign sign_ = Sign::kUnknown;
  std::optional<std::size_t> lag_;
};

}  // namespace rc10
