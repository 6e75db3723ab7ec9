#include "motor/target.hpp"

namespace rc10 {

const char* toString(ControlMode mode) noexcept {
  switch (mode) {
    case ControlMode::kCoast: return "coast";
    case ControlMode::kCurrent: return "current";
    case ControlMode::kVelocity: return "velocity";
    case ControlMode::kAngle: return "angle";
    case ControlMode::kTotalAngle: return "total_angle";
    case ControlMode::kImpedance: return "impedance";
    case ControlMode::kVoltage: return "voltage";
    case ControlMode::kDuty: return "duty";
    case ControlMode::kBrake: return "brake";
  }
  return "unknown";
}

}  // namespace rc10
