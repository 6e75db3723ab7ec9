#pragma once

#include "drives/dji/dji_model.hpp"
#include "sim/motor_physics.hpp"
#include "sim/sim_config.hpp"

namespace rc10::sim {

/// What a motor of this model is made of, behind this gear and with this load. What the load leaves
/// open (NaN) is the model's default.
[[nodiscard]] MotorParameters parametersOf(const DjiModel& model, double gear_ratio,
                                           const MotorLoad& load) noexcept;

}  // namespace rc10::sim
