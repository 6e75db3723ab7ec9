#pragma once

#include <complex>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace rc10::client {

/// The response at one frequency, output over input.
struct ResponsePoint {
  double frequency_hz = 0.0;
  std::complex<double> response;
  /// Share of the output's power that the input explains, 0 to 1: noise, play and limits lower it.
  double coherence = 0.0;

  [[nodiscard]] double gainDb() const noexcept;
};

using FrequencyResponse = std::vector<ResponsePoint>;

/// Frequencies of interest of a response.
struct FrequencyBand {
  double from_hz = 0.0;
  double to_hz = 0.0;
  double line_distance_hz = 0.0;  ///< Only multiples of it are excited; 0: all are.
};

/// Welch's estimate by cross spectra (H1) from equally spaced samples: segments that overlap by half, without
/// their mean, under a Hann window. Empty: fewer than two segments.
[[nodiscard]] FrequencyResponse estimateResponse(std::span<const double> input,
                                                 std::span<const double> output, double sample_s,
                                                 const FrequencyBand& band);

/// Phases in degrees, without jumps of a turn from point to point.
[[nodiscard]] std::vector<double> phasesDeg(const FrequencyResponse& response);

/// Where the gain of a closed loop falls below -3 dB for the first time; NaN: nowhere in the response.
[[nodiscard]] double bandwidthHz(const FrequencyResponse& closed_loop);

/// Margins of the open loop L that closed_loop = L / (1 + L) has. NaN: the crossing lies outside of the
/// response.
struct StabilityMargins {
  double gain_db = std::numeric_limits<double>::quiet_NaN();
  double gain_at_hz = std::numeric_limits<double>::quiet_NaN();  ///< Its phase is -180 degrees there.
  double phase_deg = std::numeric_limits<double>::quiet_NaN();
  double phase_at_hz = std::numeric_limits<double>::quiet_NaN();  ///< Its gain is 1 there.
};
[[nodiscard]] StabilityMargins stabilityMargins(const FrequencyResponse& closed_loop);

}  // namespace rc10::client
