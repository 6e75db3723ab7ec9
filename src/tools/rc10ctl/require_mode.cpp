#include "require_mode.hpp"

#include "client/text_table.hpp"
#include "link/words.hpp"

namespace rc10::ctl {

Result<void> requireMode(const link::MotorInfo& motor, std::uint8_t mode) {
  if ((motor.modes & (1U << mode)) != 0) return {};
  return fail("motor '" + client::printable(motor.name.view()) + "' has no mode " + link::modeWord(mode) +
              "; it has " + link::modeWords(motor.modes));
}

}  // namespace rc10::ctl
