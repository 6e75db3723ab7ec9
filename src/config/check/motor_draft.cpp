#include "config/check/motor_draft.hpp"

#include <string>

#include "config/yaml/problem.hpp"

namespace rc10 {

std::string nameOf(const MotorDraft& motor) {
  const auto& settings = motor.config.settings;
  return inQuotes(settings.name) + " (" + settings.model + " id " + std::to_string(settings.id) + ")";
}

}  // namespace rc10
