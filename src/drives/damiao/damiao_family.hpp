#pragma once

#include <cstdint>

#include "drives/damiao/damiao_model.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// DM3507 to DM10010L, DMH and DMG: all Damiao drives.
[[nodiscard]] const MotorFamily& damiaoFamily() noexcept;

/// The settings of a Damiao motor, taken out of its own keys.
struct DamiaoSettings {
  std::uint32_t master_id = 0;
  DamiaoControl control = DamiaoControl::kMit;
  std::uint32_t timeout = 0;  ///< In steps of damiao::kTimeoutStepMs.
  DamiaoScale scale;
  DamiaoGains gains;  ///< At the output shaft.
  bool can_fd = false;
};

/// `settings.model` is one of the family's. A key of 0 stands for the model's own value.
[[nodiscard]] DamiaoSettings damiaoSettings(const MotorSettings& settings);

}  // namespace rc10
