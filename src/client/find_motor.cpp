#include "client/find_motor.hpp"

#include <algorithm>
#include <vector>

#include "app/nearest.hpp"
#include "app/printable.hpp"

namespace rc10::client {
namespace {

// A count from the link is bounded before use.
std::size_t motorCount(const link::Welcome& welcome) {
  return std::min<std::size_t>(welcome.motor_count, link::kMaxMotors);
}

}  // namespace

Result<std::size_t> findMotor(const link::Welcome& welcome, std::string_view name) {
  for (std::size_t i = 0; i < motorCount(welcome); ++i) {
    if (welcome.motors[i].name.view() == name) return i;
  }
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < motorCount(welcome); ++i) names.push_back(welcome.motors[i].name.view());
  return fail("there is no motor '" + printable(name) + "'; the motors are: " + motorNames(welcome) +
              printable(didYouMean(name, names)));
}

std::string motorNames(const link::Welcome& welcome) {
  std::string names;
  for (std::size_t i = 0; i < motorCount(welcome); ++i)
    names += (names.empty() ? "" : ", ") + printable(welcome.motors[i].name.view());
  return names;
}

}  // namespace rc10::client
