#include "config/report/template.hpp"

namespace rc10 {

std::string_view configTemplate() noexcept {
  return R"(# A robot to begin with: one simulated motor. All keys: docs/configuration.md

robot: my_robot            # a-z, 0-9, _ and -
realtime: preferred        # of a real robot: required

buses:
  - name: can
    type: sim              # the real one instead of this line:
    # type: socketcan
    # interface: can0
    # manage_link: true    # rc10d sets the bit rate and takes the interface up
    motors:
      - name: wheel
        model: M3508
        id: 1
        current_limit_a: 5
        on_estop: coast
)";
}

}  // namespace rc10
