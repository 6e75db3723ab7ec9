#pragma once

#include <chrono>
#include <cstdint>

#include "app/time.hpp"
#include "app/units.hpp"

namespace rc10 {

/// Counts the turns of a single-turn encoder, exactly, in integers: a billion turns lose nothing.
///
/// The wrap is chosen by the reported speed and the elapsed time, not by the nearest one: an M2006
/// rotor makes 0.30 turns in a millisecond, so the nearest wrap is wrong after one lost frame.
/// With |acceleration| <= a, the angle moved in a gap T differs from the mean of the two reported
/// speeds times T by at most a T^2 / 4; with the speed and time errors this must stay under half a
/// turn. Beyond that gap the reference is lost, and referenceLost() says so.
///
/// Where the sample period is known, stamps that are late by up to two of them cost nothing: in truth the
/// samples lie whole periods apart, and what the encoder moved tells how many. Where it does not, and turns
/// depend on it, the reference is lost: a miscount is never silent.
class Encoder {
 public:
  struct Config {
    std::int32_t counts_per_turn = 8192;
    float max_velocity_rpm = 0.0F;  ///< Largest speed of the encoder's shaft.
    float max_acceleration_rpm_per_s = 0.0F;
    float velocity_error_rpm = 0.0F;  ///< Largest error of the reported speed, its delay included.
    Duration stamp_error{};           ///< Largest error of the spacing of two receive times.
    Duration sample_period{};         ///< Samples lie whole ones apart. 0: anywhere.
  };

  explicit Encoder(const Config& config) noexcept;

  /// Error bound of the prediction, in turns, when two samples are `spacing` apart in truth.
  [[nodiscard]] static constexpr double predictionErrorTurns(const Config& config,
                                                             Duration spacing) noexcept {
    const double t_s = std::chrono::duration<double>(spacing).count();
    const double stamp_s = std::chrono::duration<double>(config.stamp_error).count();
    const double acceleration = static_cast<double>(config.max_acceleration_rpm_per_s) / kRpmPerTurnPerS;
    const double velocity_error = static_cast<double>(config.velocity_error_rpm) / kRpmPerTurnPerS;
    const double velocity = static_cast<double>(config.max_velocity_rpm) / kRpmPerTurnPerS;
    return acceleration * t_s * t_s / 4.0 + velocity_error * t_s + velocity * stamp_s;
  }
  /// Whether counting stays exact, and is known to be, over `lost_frames` in a row that never arrive.
  /// Twice the stamp error: the gap may look longer by one, and might then be longer by another.
  [[nodiscard]] static constexpr bool exactOver(const Config& config, int lost_frames,
                                                Duration period) noexcept {
    const Duration longest = (lost_frames + 1) * period + 2 * config.stamp_error;
    return predictionErrorTurns(config, longest) < kHalfTurn;
  }

  /// One sample: position in [0, counts_per_turn), the drive's own speed, and when it was received.
  /// Returns false, and changes nothing, if the position is out of range or the speed is not finite.
  bool update(std::int32_t raw_counts, float velocity_rpm, MonotonicTime received) noexcept;
  /// The same without update()'s short cut for usual samples: by every spacing that the stamps allow.
  [[gnu::noinline]] bool updateByAllSpacings(std::int32_t raw_counts, float velocity_rpm,
                                             MonotonicTime received) noexcept;

  /// Counts since the first sample's turn began: raw position plus whole turns.
  [[nodiscard]] std::int64_t totalCounts() const noexcept { return total_counts_; }
  [[nodiscard]] bool hasSample() const noexcept { return has_sample_; }
  /// A gap was too long to know the number of turns. Stays until acknowledgeLoss().
  [[nodiscard]] bool referenceLost() const noexcept { return reference_lost_; }
  void acknowledgeLoss() noexcept { reference_lost_ = false; }
  /// Number of losses of the turns.
  [[nodiscard]] std::uint64_t losses() const noexcept { return losses_; }
  /// Samples farther from the one before than the shaft can have turned, at the speeds that both
  /// report. Each loses the reference. Not noticed at speeds where late stamps could explain it.
  [[nodiscard]] std::uint64_t jumps() const noexcept { return jumps_; }

  /// Delay of the last stamp, as far as is known.
  [[nodiscard]] Duration stampDelay() const noexcept { return late_; }
  /// The longest spacing of two receive times over which counting stays exact.
  [[nodiscard]] Duration longestGap() const noexcept { return longest_gap_; }

 private:
  /// Half a turn, less two counts of position quantisation.
  static constexpr double kHalfTurn = 0.4997;

  /// Turns of one step, and how sure they are.
  struct Step {
    std::int32_t turns = 0;  ///< Whole ones, beside the difference of the two positions.
    bool explained = false;  ///< By the speeds, at a spacing that the stamps allow.
    bool in_doubt = false;   ///< Another spacing would be another number of turns.
    double off = 0.0;        ///< Turns that the prediction was off, to either side.
  };

  /// Counts a sample that lies about a period after the one before, and whose turn is the same at any of the
  /// spacings it can have. False: it is another one, and nothing has changed.
  [[nodiscard]] bool countUsual(std::int32_t raw_counts, float velocity_rpm, MonotonicTime received) noexcept;
  void remember(Duration late, Duration gap) noexcept;
  void loseReference() noexcept;
  [[nodiscard]] Step stepOver(double moved_turns, double turns_per_ns, double spacing_ns) const noexcept;
  [[nodiscard]] Step chooseStep(double moved_turns, double turns_per_ns, Duration gap) noexcept;
  /// predictionErrorTurns() without an error of the stamps.
  [[nodiscard]] double errorTurns(double spacing_ns) const noexcept {
    return (error_per_ns2_ * spacing_ns + error_per_ns_) * spacing_ns;
  }
  [[nodiscard]] bool jumped(double off_turns, float velocity_rpm, Duration gap) const noexcept;

  Config config_;
  double turns_per_count_;
  double error_per_ns2_;  ///< Error of the acceleration, in turns.
  double error_per_ns_;   ///< Error of the reported speed, in turns.
  double period_ns_;
  Duration rounding_;  ///< Makes whole sample periods of a time: up but for a twentieth of one.
  Duration longest_gap_{};
  Duration longest_usual_{};  ///< Time that counts as one period, and is no gap. Below 0: there is no period.
  std::uint64_t losses_ = 0;
  std::uint64_t jumps_ = 0;
  std::int64_t total_counts_ = 0;
  std::int32_t raw_counts_ = 0;
  double velocity_rpm_ = 0.0;
  MonotonicTime received_;
  Duration late_{};  ///< Delay of the last stamp, as far as is known.
  bool has_sample_ = false;
  bool reference_lost_ = false;
};

}  // namespace rc10
