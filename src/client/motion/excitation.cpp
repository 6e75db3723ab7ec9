#include "client/motion/excitation.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include <unsupported/Eigen/FFT>

#include "app/units.hpp"
#include "client/quantity_text.hpp"

namespace rc10::client {
namespace {

constexpr std::array kExcitationWords{std::string_view{"step"}, std::string_view{"ramp"},
                                      std::string_view{"sweep"}, std::string_view{"multisine"}};
// Lowest frequency: a period within a test.
constexpr double kLowestHz = 0.05;
// Fewer periods leave no mean over segments, and without a mean every coherence is 1.
constexpr double kLeastPeriods = 4.0;

Result<void> sinesFit(const ExcitationSettings& settings) {
  const double from_hz = settings.from_hz;
  const double to_hz = settings.to_hz;
  const double time_s = settings.time_s;
  if (!(from_hz >= kLowestHz && to_hz > from_hz && to_hz <= Excitation::kHighestHz))
    return fail("from " + number(from_hz, 2) + " Hz to " + number(to_hz, 2) +
                " Hz: give two frequencies from " + number(kLowestHz, 2) + " to " +
                number(Excitation::kHighestHz, 0) + " Hz, the lower one first");
  if (time_s * from_hz < kLeastPeriods)
    return fail("a time of " + number(time_s, 2) + " s has no " + number(kLeastPeriods, 0) + " periods of " +
                number(from_hz, 2) + " Hz: give " + number(kLeastPeriods / from_hz, 1) +
                " s or more, or a higher lowest frequency");
  if (settings.kind == ExcitationKind::kMultisine && to_hz < 2.0 * from_hz)
    return fail("a multisine has lines at multiples of the lowest frequency: give a highest one of " +
                number(2.0 * from_hz, 2) + " Hz or more");
  return {};
}

// Largest magnitude of lines of height 1 within a period, between the samples that a client sends too.
double peakOf(const std::vector<double>& phases_rad) {
  const std::size_t samples = std::bit_ceil(40 * phases_rad.size());
  std::vector<std::complex<double>> lines(samples);
  for (std::size_t k = 0; k < phases_rad.size(); ++k) lines[k + 1] = std::polar(1.0, phases_rad[k]);
  std::vector<std::complex<double>> period;
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::Unscaled);
  fft.inv(period, lines);
  double peak = 0.0;
  for (const auto& value : period) peak = std::max(peak, std::abs(value.real()));
  return peak;
}

}  // namespace

std::optional<ExcitationKind> excitationOf(std::string_view word) noexcept {
  const auto found = std::find(kExcitationWords.begin(), kExcitationWords.end(), word);
  if (found == kExcitationWords.end()) return std::nullopt;
  return static_cast<ExcitationKind>(found - kExcitationWords.begin());
}

const char* toString(ExcitationKind kind) noexcept {
  return kExcitationWords[static_cast<std::size_t>(kind)].data();
}

Result<Excitation> Excitation::of(const ExcitationSettings& settings) {
  if (!std::isfinite(settings.base)) return fail("the base is no finite number: give one such as 0");
  if (!std::isfinite(settings.amplitude) || settings.amplitude == 0.0)
    return fail("an amplitude of " + number(settings.amplitude, 2) +
                " moves nothing: give a finite number such as 60");
  if (!(settings.time_s >= 0.05 && settings.time_s <= kLongestS))
    return fail("a time of " + number(settings.time_s, 2) + " s: give 0.05 to " + number(kLongestS, 0) +
                " s");
  if (settings.kind == ExcitationKind::kRamp) {
    if (!(std::isfinite(settings.rate_per_s) && settings.rate_per_s > 0.0))
      return fail("a ramp needs a rate above 0, in units of its amplitude for each second, such as 100");
    const double rising_s = std::abs(settings.amplitude) / settings.rate_per_s;
    if (rising_s > settings.time_s)
      return fail("a ramp of " + number(settings.rate_per_s, 2) + " a second takes " + number(rising_s, 2) +
                  " s for its amplitude: give a longer time than " + number(settings.time_s, 2) +
                  " s, or a higher rate");
  }
  if (settings.kind == ExcitationKind::kSweep || settings.kind == ExcitationKind::kMultisine) {
    if (const auto fit = sinesFit(settings); !fit) return tl::unexpected(fit.error());
  }
  return Excitation(settings);
}

Excitation::Excitation(const ExcitationSettings& settings) : settings_(settings) {
  if (settings_.kind != ExcitationKind::kMultisine) return;
  const auto lines = static_cast<std::size_t>(settings_.to_hz / settings_.from_hz + 1e-9);
  // Schroeder 1970, "Synthesis of low-peak-factor signals": phases for lines of equal power.
  for (std::size_t k = 0; k < lines; ++k)
    phases_rad_.push_back(-std::numbers::pi * static_cast<double>(k) * static_cast<double>(k + 1) /
                          static_cast<double>(lines));
  line_amplitude_ = settings_.amplitude / peakOf(phases_rad_);
}

double Excitation::valueAt(double time_s, double start) const noexcept {
  const double after_lead_s = time_s - kLeadS;
  if (after_lead_s < 0.0) return approachAt(time_s, start);
  const double since_s = std::min(after_lead_s, settings_.time_s);
  double beside = settings_.amplitude;
  switch (settings_.kind) {
    case ExcitationKind::kStep: break;
    case ExcitationKind::kRamp:
      beside = std::copysign(std::min(std::abs(beside), settings_.rate_per_s * since_s), beside);
      break;
    case ExcitationKind::kSweep: beside = sweepAt(after_lead_s); break;
    case ExcitationKind::kMultisine: beside = multisineAt(since_s); break;
  }
  return settings_.base + beside;
}

// Half a cosine: without a jump of the value or its slope.
double Excitation::approachAt(double time_s, double start) const noexcept {
  const double part = std::clamp(time_s / (0.5 * kLeadS), 0.0, 1.0);
  return start + (settings_.base - start) * 0.5 * (1.0 - std::cos(std::numbers::pi * part));
}

// Windows of the estimate are two periods of the lowest frequency long and overlap by one. The highest
// frequencies, in the flank of the last one, would be off by decibels: one period of rest brings them into
// the middle of a window, and no part of the sweep is left over.
double Excitation::timeS() const noexcept {
  if (settings_.kind != ExcitationKind::kSweep) return kLeadS + settings_.time_s;
  return kLeadS + (std::ceil(settings_.time_s * settings_.from_hz - 1e-9) + 1.0) / settings_.from_hz;
}

double Excitation::sweepTurns(double time_s) const noexcept {
  const double from_hz = settings_.from_hz;
  if (settings_.linear) {
    return (from_hz + 0.5 * (settings_.to_hz - from_hz) * time_s / settings_.time_s) * time_s;
  }
  const double growth = std::log(settings_.to_hz / from_hz);
  return from_hz * settings_.time_s / growth * std::expm1(growth * time_s / settings_.time_s);
}

// It goes on at its highest frequency to the next half turn: the target does not jump to the base.
double Excitation::sweepAt(double time_s) const noexcept {
  const double over_s = time_s - settings_.time_s;
  if (over_s <= 0.0) return settings_.amplitude * std::sin(kRadPerTurn * sweepTurns(time_s));
  const double last_turns = sweepTurns(settings_.time_s);
  const double turns = last_turns + over_s * settings_.to_hz;
  const double end_turns = 0.5 * std::ceil(2.0 * last_turns - 1e-9);
  return turns < end_turns ? settings_.amplitude * std::sin(kRadPerTurn * turns) : 0.0;
}

double Excitation::multisineAt(double time_s) const noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < phases_rad_.size(); ++k)
    sum += std::cos(kRadPerTurn * settings_.from_hz * static_cast<double>(k + 1) * time_s + phases_rad_[k]);
  return line_amplitude_ * sum;
}

bool Excitation::spansFrequencies() const noexcept {
  return settings_.kind == ExcitationKind::kSweep || settings_.kind == ExcitationKind::kMultisine;
}

double Excitation::lowest() const noexcept {
  const double low = spansFrequencies() ? -std::abs(settings_.amplitude) : std::min(0.0, settings_.amplitude);
  return settings_.base + low;
}

double Excitation::highest() const noexcept {
  const double high = spansFrequencies() ? std::abs(settings_.amplitude) : std::max(0.0, settings_.amplitude);
  return settings_.base + high;
}

}  // namespace rc10::client
