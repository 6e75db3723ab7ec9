#include "motor/motor_family.hpp"

namespace rc10 {

Result<void> BusParts::add(std::unique_ptr<CommandPacker> packer) {
  if (auto registered = bus_.registerMotor(*packer); !registered) return registered;
  owned_.push_back(std::move(packer));
  return {};
}

Result<void> MotorFamily::check(const MotorSettings& /*settings*/) const { return {}; }

}  // namespace rc10
