#include "config/check/bus_load_check.hpp"

#include <algorithm>
#include <cmath>

#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

/// The lowest rate that a motor which speaks unasked can be set to; 0: none does.
int lowestRate(const BusConfig& bus) {
  int lowest_hz = 0;
  for (const auto& motor : bus.motors) {
    const MotorTraits traits = motor.traits();
    if (!traits.asked) lowest_hz = std::max(lowest_hz, traits.min_feedback_hz);
  }
  return lowest_hz;
}

std::string remedy(const BusConfig& bus, int rate_hz) {
  const int fits_hz = feedbackRateThatFits(bus, rate_hz);
  const int lowest_hz = lowestRate(bus);
  const std::string elsewhere = "move motors to another bus";
  if (const int divider = dividerThatFits(bus, rate_hz); divider > 1) {
    return "command_divider: " + std::to_string(divider) +
           " or more for the motors with frames of their own keeps it within " + percentText(kCrowdedLoad) +
           "; or " + elsewhere;
  }
  if (lowest_hz == 0 || fits_hz < lowest_hz) {
    return "no feedback rate fits at scheduler.rate_hz " + std::to_string(rate_hz) + ": " + elsewhere +
           ", or lower rate_hz";
  }
  return "feedback at " + std::to_string(fits_hz) +
         " Hz or less (set on the drives, then feedback_hz) keeps it within " + percentText(kCrowdedLoad) +
         "; or " + elsewhere;
}

}  // namespace

std::string percentText(double fraction) { return numberText(std::round(fraction * 1000.0) / 10.0) + " %"; }

std::string loadText(const BusLoad& load) {
  return percentText(load.unstuffed) + " to " + percentText(load.worst_case);
}

void checkBusLoad(const BusConfig& bus, int rate_hz, const std::string& path, Problems& problems) {
  const BusLoad load = predictLoad(bus, rate_hz);
  const std::string predicted = "predicted load " + loadText(load) + " (no stuff bits, all stuff bits) of " +
                                std::to_string(bus.bitrate) + " bit/s";
  if (load.unstuffed > 1.0) {
    problems.error(bus.place, path, predicted + " does not fit; " + remedy(bus, rate_hz));
  } else if (load.worst_case > kCrowdedLoad) {
    problems.warning(bus.place, path, predicted + " makes frames wait; " + remedy(bus, rate_hz));
  }
}

}  // namespace rc10
