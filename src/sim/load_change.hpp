#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "app/time.hpp"
#include "sim/sim_config.hpp"

namespace rc10::sim {

/// Figure of a load that may change while the shaft turns. The name is its key in the robot's file.
struct LoadFigure {
  std::string_view name;
  float MotorLoad::*field;
};
inline constexpr std::array<LoadFigure, 7> kLoadFigures{
    {{"inertia_kg_m2", &MotorLoad::inertia_kg_m2},
     {"viscous_nms_per_rad", &MotorLoad::viscous_nms_per_rad},
     {"coulomb_nm", &MotorLoad::coulomb_nm},
     {"load_torque_nm", &MotorLoad::load_torque_nm},
     {"gravity_nm", &MotorLoad::gravity_nm},
     {"payload_kg", &MotorLoad::payload_kg},
     {"payload_at_m", &MotorLoad::payload_at_m}}};

/// Change of a load. Figures without a value stay.
struct LoadChange {
  bool back = false;  ///< First all figures become those of the start.
  std::array<std::optional<float>, kLoadFigures.size()> values{};

  /// The load after this change.
  [[nodiscard]] MotorLoad of(MotorLoad load, const MotorLoad& at_start) const noexcept {
    for (std::size_t i = 0; i < kLoadFigures.size(); ++i) {
      const auto field = kLoadFigures[i].field;
      if (back) load.*field = at_start.*field;
      if (const auto& value = values[i]) load.*field = *value;
    }
    return load;
  }
};

/// Changes that come by themselves, in the order of their times.
struct LoadPlan {
  struct Step {
    Duration after{};  ///< Since the start, or since the plan began anew.
    LoadChange change;
  };
  std::vector<Step> steps;
  Duration repeat{};  ///< It begins anew so often, with the load of the start; 0: never.
};

}  // namespace rc10::sim
