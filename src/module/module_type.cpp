#include "module/module_type.hpp"

namespace rc10 {

Result<void> RobotOutline::require(ControlMode mode, std::size_t motor, std::string_view key) const {
  const auto& wanted = motors[motor];
  if (wanted.modes.contains(mode)) return {};
  return fail(std::string{key} + ": motor '" + wanted.name + "' takes no " + toString(mode) +
              " targets; name another motor, or set up its drive for them");
}

}  // namespace rc10
