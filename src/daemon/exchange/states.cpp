#include "daemon/exchange/states.hpp"

namespace rc10 {

const char* toString(MotorStatus status) noexcept {
  switch (status) {
    case MotorStatus::kOffline: return "OFFLINE";
    case MotorStatus::kReady: return "READY";
    case MotorStatus::kEnabling: return "ENABLING";
    case MotorStatus::kActive: return "ACTIVE";
    case MotorStatus::kFault: return "FAULT";
  }
  return "UNKNOWN";
}

const char* toString(RobotState state) noexcept {
  switch (state) {
    case RobotState::kRun: return "RUN";
    case RobotState::kEstop: return "ESTOP";
    case RobotState::kStopping: return "STOPPING";
  }
  return "UNKNOWN";
}

}  // namespace rc10
