#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "config/keys/key_table.hpp"
#include "config/keys/settings.hpp"
#include "config/yaml/problem.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// Properties of a motor that keys depend on.
struct MotorNature {
  std::string_view model;
  const MotorTraits& traits;
  bool absolute = false;       ///< Knows its output angle at power-up.
  bool incremental = false;    ///< Type of the velocity loop.
  bool shares_frames = false;  ///< Its commands travel with those of others.

  [[nodiscard]] std::uint16_t metNeeds() const noexcept;
};

/// "reason; fix" for a key whose `unmet` needs this motor does not meet. Names the model and never the motor:
/// a profile's mistake is one mistake for all its motors.
[[nodiscard]] std::string whyMeaningless(const Key& key, std::uint16_t unmet, const MotorNature& nature);

/// Reports keys that mean nothing for such a motor, with the one to use instead.
void checkNeeds(const Settings& given, const Section& section, const MotorNature& nature, Problems& problems);

}  // namespace rc10
