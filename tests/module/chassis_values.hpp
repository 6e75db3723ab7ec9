#pragma once

#include <initializer_list>
#include <string>

#include "module/module_type.hpp"

namespace rc10::test {

inline OwnValues common() {
  OwnValues own;
  own.set("max_speed_m_s", 2.0);
  own.set("max_turn_deg_s", 360.0);
  own.set("max_acceleration_m_s2", 4.0);
  own.set("max_turn_acceleration_deg_s2", 720.0);
  own.set("follow_gain_per_s", 5.0);
  own.set("power_limit_w", 0.0);
  own.set("loss_w_per_nm2", 0.0);
  own.set("wheel_radius_m", 0.076);
  own.set("track_m", 0.5);
  own.set("wheelbase_m", 0.4);
  own.set("centre_distance_m", 0.3);
  own.set("middle_wheel", std::string{"rear"});
  return own;
}

inline OwnValues section(std::initializer_list<const char*> names, std::size_t first = 0) {
  OwnValues section;
  for (const auto* name : names) section.set(name, static_cast<double>(first++));
  return section;
}

}  // namespace rc10::test
