#include "client/motion/frequency_response.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <unsupported/Eigen/FFT>

#include "app/angle.hpp"
#include "app/units.hpp"

namespace rc10::client {
namespace {

using Complex = std::complex<double>;

// Length of a segment in periods of the lowest frequency: a Hann window smears over two bins to each side,
// and two halves of it still give a mean.
constexpr double kPeriodsInSegment = 2.0;
// An input weaker than this share of its strongest line is leakage.
constexpr double kLeastInput = 1e-6;
// Nothing has followed an input whose output has less than this share of its power: -120 dB.
constexpr double kLeastOutput = 1e-12;
// Less of the output than this is explained: the point shows noise, and no crossing is read from it.
constexpr double kLeastCoherence = 0.5;

struct Spectra {
  std::vector<double> input;
  std::vector<double> output;
  std::vector<Complex> cross;
};

std::vector<Complex> windowed(std::span<const double> segment, const std::vector<double>& window,
                              Eigen::FFT<double>& fft) {
  const auto size = static_cast<double>(segment.size());
  const double mean = std::accumulate(segment.begin(), segment.end(), 0.0) / size;
  std::vector<double> tapered(segment.size());
  for (std::size_t i = 0; i < segment.size(); ++i) tapered[i] = (segment[i] - mean) * window[i];
  std::vector<Complex> spectrum;
  fft.fwd(spectrum, tapered);
  return spectrum;
}

Spectra welch(std::span<const double> input, std::span<const double> output, std::size_t size) {
  std::vector<double> window(size);
  for (std::size_t i = 0; i < size; ++i)
    window[i] = 0.5 - 0.5 * std::cos(kRadPerTurn * static_cast<double>(i) / static_cast<double>(size));
  const std::size_t bins = size / 2 + 1;
  Spectra sums{std::vector<double>(bins), std::vector<double>(bins), std::vector<Complex>(bins)};
  Eigen::FFT<double> fft;
  for (std::size_t first = 0; first + size <= input.size(); first += size / 2) {
    const auto in = windowed(input.subspan(first, size), window, fft);
    const auto out = windowed(output.subspan(first, size), window, fft);
    for (std::size_t k = 0; k < bins; ++k) {
      sums.input[k] += std::norm(in[k]);
      sums.output[k] += std::norm(out[k]);
      sums.cross[k] += std::conj(in[k]) * out[k];
    }
  }
  return sums;
}

bool isLine(double frequency_hz, double bin_hz, double distance_hz) {
  if (distance_hz <= 0.0) return true;
  return std::abs(std::remainder(frequency_hz, distance_hz)) < 0.5 * bin_hz;
}

// Share of the way from one point to the next at which the value is 0.
double zeroShare(double before, double after) { return before / (before - after); }

double betweenHz(const ResponsePoint& before, const ResponsePoint& after, double share) {
  return before.frequency_hz * std::pow(after.frequency_hz / before.frequency_hz, share);
}

double unwrapped(double phase_deg, double near_deg) { return near_deg + wrapHalfTurn(phase_deg - near_deg); }

}  // namespace

double ResponsePoint::gainDb() const noexcept { return 20.0 * std::log10(std::abs(response)); }

FrequencyResponse estimateResponse(std::span<const double> input, std::span<const double> output,
                                   double sample_s, const FrequencyBand& band) {
  const std::size_t samples = std::min(input.size(), output.size());
  // Even, and a whole number of periods: the lines of a multisine lie on bins.
  const auto half = static_cast<std::size_t>(std::lround(kPeriodsInSegment / 2.0 / band.from_hz / sample_s));
  const std::size_t size = 2 * half;
  if (half < 4 || samples < size + half) return {};
  const Spectra sums = welch(input.first(samples), output.first(samples), size);
  const double bin_hz = 1.0 / (static_cast<double>(size) * sample_s);
  const double strongest = *std::max_element(sums.input.begin() + 1, sums.input.end());
  FrequencyResponse response;
  for (std::size_t k = 1; k < sums.input.size(); ++k) {
    const double frequency_hz = static_cast<double>(k) * bin_hz;
    if (frequency_hz < band.from_hz - 0.5 * bin_hz || frequency_hz > band.to_hz + 0.5 * bin_hz) continue;
    if (!isLine(frequency_hz, bin_hz, band.line_distance_hz)) continue;
    const double powers = sums.input[k] * sums.output[k];
    if (sums.input[k] < kLeastInput * strongest || !(sums.output[k] > kLeastOutput * sums.input[k])) continue;
    response.push_back({frequency_hz, sums.cross[k] / sums.input[k], std::norm(sums.cross[k]) / powers});
  }
  return response;
}

std::vector<double> phasesDeg(const FrequencyResponse& response) {
  std::vector<double> phases;
  for (const auto& point : response) {
    phases.push_back(unwrapped(toDegrees(std::arg(point.response)), phases.empty() ? 0.0 : phases.back()));
  }
  return phases;
}

double bandwidthHz(const FrequencyResponse& closed_loop) {
  constexpr double kEdgeDb = -3.0;
  const ResponsePoint* before = nullptr;
  for (const auto& point : closed_loop) {
    if (point.coherence < kLeastCoherence) continue;
    const double above = point.gainDb() - kEdgeDb;
    if (above < 0.0) {
      if (before == nullptr) break;  // it lies below the lowest frequency
      return betweenHz(*before, point, zeroShare(before->gainDb() - kEdgeDb, above));
    }
    before = &point;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

StabilityMargins stabilityMargins(const FrequencyResponse& closed_loop) {
  FrequencyResponse open_loop;
  for (auto point : closed_loop) {
    if (point.coherence < kLeastCoherence) continue;
    point.response /= 1.0 - point.response;
    open_loop.push_back(point);
  }
  const auto phases = phasesDeg(open_loop);
  StabilityMargins margins;
  for (std::size_t i = 1; i < open_loop.size(); ++i) {
    const auto& before = open_loop[i - 1];
    const auto& after = open_loop[i];
    if (std::isnan(margins.phase_deg) && before.gainDb() >= 0.0 && after.gainDb() < 0.0) {
      const double share = zeroShare(before.gainDb(), after.gainDb());
      margins.phase_at_hz = betweenHz(before, after, share);
      margins.phase_deg = 180.0 + phases[i - 1] + share * (phases[i] - phases[i - 1]);
    }
    if (std::isnan(margins.gain_db) && phases[i - 1] > -180.0 && phases[i] <= -180.0) {
      const double share = zeroShare(phases[i - 1] + 180.0, phases[i] + 180.0);
      margins.gain_at_hz = betweenHz(before, after, share);
      margins.gain_db = -(before.gainDb() + share * (after.gainDb() - before.gainDb()));
    }
  }
  return margins;
}

}  // namespace rc10::client
