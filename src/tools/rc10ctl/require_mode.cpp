#include "require_mode.hpp"

#include "app/printable.hpp"
#include "config/keys/mode_setting.hpp"
#include "link/words.hpp"

namespace rc10::ctl {

Result<void> requireMode(const link::MotorInfo& motor, ControlMode mode) {
  if ((motor.modes & (1U << static_cast<unsigned>(mode))) != 0) return {};
  const std::string setting = settingForMode(motor.model.view(), mode);
  return fail(
      "motor '" + printable(motor.name.view()) + "' has no mode " + toString(mode) + "; it has " +
      link::modeWords(motor.modes) +
      (setting.empty() ? "" : ". Write `" + setting + "` for it into the robot's file and restart rc10d"));
}

}  // namespace rc10::ctl
