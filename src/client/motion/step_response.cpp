#include "client/motion/step_response.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace rc10::client {
namespace {

constexpr double kSettledWithin = 0.02;
// Parts of the time after the step: where the steady state is taken from, and for how long a response has to
// have stayed settled.
constexpr double kSteadyPart = 0.2;
constexpr double kSettledPart = 0.05;

using Values = std::vector<double>;

// The instant between two samples at which the level is crossed.
double crossingS(const Values& times, const Values& values, std::size_t at, double level) {
  const double share = (level - values[at - 1]) / (values[at] - values[at - 1]);
  return times[at - 1] + share * (times[at] - times[at - 1]);
}

double firstAboveS(const Values& times, const Values& part, double level) {
  const auto found = std::find_if(part.begin(), part.end(), [level](double p) { return p >= level; });
  if (found == part.end()) return StepResponse::kUnknown;
  const auto at = static_cast<std::size_t>(found - part.begin());
  return at == 0 ? times[0] : crossingS(times, part, at, level);
}

double settledAfterS(const Values& times, const Values& distance) {
  const auto outside =
      std::find_if(distance.rbegin(), distance.rend(), [](double d) { return d > kSettledWithin; });
  if (outside == distance.rend()) return times.front();
  const auto last = static_cast<std::size_t>(distance.rend() - outside) - 1;
  // To pass through the band when the time is over is not to have settled.
  const double latest_s = times.back() - kSettledPart * (times.back() - times.front());
  if (last + 1 >= times.size() || times[last] > latest_s) return StepResponse::kUnknown;
  return crossingS(times, distance, last + 1, kSettledWithin);
}

}  // namespace

StepResponse judgeStep(std::span<const double> time_s, std::span<const double> response, double start,
                       double target) {
  Values times;
  Values part;  // 0 at the start, 1 at the target, whatever the direction
  for (std::size_t i = 0; i < std::min(time_s.size(), response.size()); ++i) {
    if (time_s[i] < 0.0 || !std::isfinite(response[i])) continue;
    times.push_back(time_s[i]);
    part.push_back((response[i] - start) / (target - start));
  }
  if (times.size() < 3 || !std::isfinite(target - start) || target == start) return {};
  StepResponse numbers;
  const auto peak = static_cast<std::size_t>(std::max_element(part.begin(), part.end()) - part.begin());
  numbers.rise_s = firstAboveS(times, part, 0.9) - firstAboveS(times, part, 0.1);
  numbers.overshoot_percent = std::max(0.0, part[peak] - 1.0) * 100.0;
  numbers.peak = start + part[peak] * (target - start);
  numbers.peak_s = times[peak];
  Values distance(part.size());
  std::transform(part.begin(), part.end(), distance.begin(), [](double p) { return std::abs(p - 1.0); });
  numbers.settling_s = settledAfterS(times, distance);
  const double steady_from_s = times.back() - kSteadyPart * (times.back() - times.front());
  const auto first = std::lower_bound(times.begin(), times.end(), steady_from_s) - times.begin();
  const double steady = std::accumulate(part.begin() + first, part.end(), 0.0) /
                        static_cast<double>(part.end() - part.begin() - first);
  numbers.steady_error = (1.0 - steady) * (target - start);
  return numbers;
}

FollowingError followingError(std::span<const double> target, std::span<const double> response) {
  double squares = 0.0;
  double max = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(target.size(), response.size()); ++i) {
    const double error = target[i] - response[i];
    if (!std::isfinite(error)) continue;
    squares += error * error;
    max = std::max(max, std::abs(error));
    ++count;
  }
  if (count == 0) return {};
  return {std::sqrt(squares / static_cast<double>(count)), max};
}

}  // namespace rc10::client
