#include "motor/motor_family.hpp"

namespace rc10 {

Result<void> MotorFamily::check(const MotorSettings& /*settings*/) const { return {}; }

}  // namespace rc10
