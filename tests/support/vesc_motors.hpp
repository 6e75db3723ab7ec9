#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drives/vesc/vesc_family.hpp"
#include "drives/vesc/vesc_motor.hpp"
#include "support/frame_bytes.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test {

/// A VESC as configured with its defaults and 7 pole pairs, id 7.
inline MotorSettings vescSettings(const std::vector<std::pair<std::string, OwnValues::Value>>& own = {}) {
  MotorSettings settings;
  settings.name = "shooter";
  settings.model = "VESC";
  settings.id = 7;
  settings.feedback_hz = 100;
  settings.own = ownDefaults(vescFamily());
  settings.own.set("pole_pairs", 7.0);
  for (const auto& [key, value] : own) settings.own.set(key, value);
  const auto traits = vescFamily().traits("VESC", settings.own);
  if (traits.host_loops != nullptr) settings.loops = *traits.host_loops;
  return settings;
}

/// An extended frame from its payload in hexadecimal.
inline CanFrame vescFrame(std::uint32_t id, std::string_view hex) { return frameOf(CanId{id, true}, hex); }

}  // namespace rc10::test
