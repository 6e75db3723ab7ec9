#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "app/result.hpp"

namespace rc10::client {

enum class ExcitationKind : std::uint8_t { kStep, kRamp, kSweep, kMultisine };

/// "step", "ramp", "sweep", "multisine"; empty: none of them.
[[nodiscard]] std::optional<ExcitationKind> excitationOf(std::string_view word) noexcept;
[[nodiscard]] const char* toString(ExcitationKind kind) noexcept;

/// Shape of a target over time. Values are in the unit of the control mode, beside the base.
struct ExcitationSettings {
  ExcitationKind kind = ExcitationKind::kStep;
  double base = 0.0;        ///< Target before the excitation, and the centre of sines.
  double amplitude = 0.0;   ///< Height of a step or ramp, with its sign; peak of sines.
  double time_s = 1.5;      ///< Duration of the excitation, after the lead.
  double rate_per_s = 0.0;  ///< Slope of a ramp.
  double from_hz = 1.0;     ///< Lowest frequency; the distance of a multisine's lines too.
  double to_hz = 20.0;
  bool linear = false;  ///< Sweep: the frequency rises by equal amounts, not by equal ratios.
};

/// A target as a function of time, and nothing else.
class Excitation {
 public:
  /// Time before the excitation: half of it from where the motor is to the base, half at the base, so that
  /// the response begins from a steady state. rc10d's soft start of a new owner is over by then.
  static constexpr double kLeadS = 1.0;
  static constexpr double kLongestS = 120.0;
  /// A client sends a target every 2 ms; a sine needs ten of them.
  static constexpr double kHighestHz = 50.0;

  /// The error names the setting, its range and an example.
  [[nodiscard]] static Result<Excitation> of(const ExcitationSettings& settings);

  /// `start`: the value from which the base is approached.
  [[nodiscard]] double valueAt(double time_s, double start) const noexcept;
  /// With the lead, and after a sweep the time at the base in which its end is still measured.
  [[nodiscard]] double timeS() const noexcept;
  /// Bounds of valueAt() after the lead.
  [[nodiscard]] double lowest() const noexcept;
  [[nodiscard]] double highest() const noexcept;
  [[nodiscard]] const ExcitationSettings& settings() const noexcept { return settings_; }
  /// It excites a range of frequencies: a frequency response can be computed.
  [[nodiscard]] bool spansFrequencies() const noexcept;

 private:
  explicit Excitation(const ExcitationSettings& settings);

  [[nodiscard]] double approachAt(double time_s, double start) const noexcept;
  [[nodiscard]] double sweepAt(double time_s) const noexcept;
  [[nodiscard]] double sweepTurns(double time_s) const noexcept;
  [[nodiscard]] double multisineAt(double time_s) const noexcept;

  ExcitationSettings settings_;
  std::vector<double> phases_rad_;  ///< Phases of a multisine's lines.
  double line_amplitude_ = 0.0;
};

}  // namespace rc10::client
