#pragma once

#include "drives/dji/dji_model.hpp"
#include "sim/motor_physics.hpp"
#include "sim/sim_config.hpp"

namespace rc10::sim {

/// Physical parameters of a motor of this model with this gear and load. NaN in the load: the model's
/// default.
[[nodiscard]] MotorParameters parametersOf(const DjiModel& model, double gear_ratio,
                                           const MotorLoad& load) noexcept;

}  // namespace rc10::sim
