#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "link/link_protocol.hpp"

namespace rc10::client {

/// One number of one motor's state, under the name that motor_state_t.lcm and `--json` have for it.
struct MotorSignal {
  std::size_t motor = 0;  ///< Its place in Welcome and State.
  std::string name;       ///< "yaw.velocity_rpm"
  double (*read)(const link::MotorState& motor) = nullptr;

  /// NaN: not reported.
  [[nodiscard]] double of(const link::State& state) const;
};

/// "yaw.velocity_rpm", or "yaw.velocity": the unit may be left out. The error lists what there is.
[[nodiscard]] Result<MotorSignal> findSignal(const link::Welcome& welcome, std::string_view text);

}  // namespace rc10::client
