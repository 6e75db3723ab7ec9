#pragma once

#include <memory>

#include "motor/motor_settings.hpp"
#include "sim/drive.hpp"

namespace acme {

/// The simulated Turner: takes the real commands and gives the real feedback.
[[nodiscard]] std::unique_ptr<rc10::sim::Drive> makeAcmeDrive(const rc10::MotorSettings& settings,
                                                              const rc10::sim::MotorLoad& load);

}  // namespace acme
