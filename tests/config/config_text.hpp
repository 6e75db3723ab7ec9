#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/load_config.hpp"
#include "drives/dji/dji_family.hpp"

namespace rc10::test {

inline std::vector<std::string> lines(const std::vector<ConfigProblem>& problems) {
  std::vector<std::string> text;
  for (const auto& problem : problems) text.push_back(toString(problem));
  return text;
}

inline std::vector<std::string> errorsOf(std::string_view text) {
  return lines(parseRobotConfig(text, "hero.yaml").errors);
}

inline std::vector<std::string> warningsOf(std::string_view text) {
  return lines(parseRobotConfig(text, "hero.yaml").warnings);
}

/// A robot with this one motor, which stands in line 6 from column 9 on.
inline std::string robotWith(const std::string& motor) {
  return "robot: hero\nbuses:\n  - name: chassis\n    type: sim\n    motors:\n      - " + motor + "\n";
}

/// A good robot, preceded by these lines.
inline std::string robotAfter(const std::string& head) {
  return head + "buses:\n  - {name: chassis, type: sim, motors: [{name: wheel, model: M3508, id: 1}]}\n";
}

/// The configuration of the one motor of robotWith(); its errors fail the test by an exception.
inline MotorConfig motorOf(const std::string& motor) {
  return parseRobotConfig(robotWith(motor), "hero.yaml").config.value().buses.at(0).motors.at(0);
}

}  // namespace rc10::test
