#include "config/build/motor_names.hpp"

#include <algorithm>

#include "app/nearest.hpp"

namespace rc10 {

MotorNames::MotorNames(const std::vector<BusConfig>& buses) {
  for (const auto& bus : buses) {
    for (const auto& motor : bus.motors) names_.push_back(motor.name());
  }
}

std::optional<std::size_t> MotorNames::find(const GivenValue& given, Problems& problems) const {
  const auto found = std::find(names_.begin(), names_.end(), given.text());
  if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
  const auto meant = didYouMean(given.text(), {names_.begin(), names_.end()});
  problems.error(given.place(), given.path,
                 "there is no motor " + inQuotes(given.text()) +
                     (meant.empty() ? "; name one of the motors of buses" : meant));
  return std::nullopt;
}

}  // namespace rc10
