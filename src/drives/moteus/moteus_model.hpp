#pragma once

#include <cstdint>
#include <string_view>

#include "motor/fault_code.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// Settings of one moteus, from its own keys.
struct MoteusSettings {
  double rotor_to_output_ratio = 1.0;
  bool bit_rate_switch = true;
  std::uint32_t can_prefix = 0;
  int watchdog_ms = 100;
};
[[nodiscard]] MoteusSettings moteusSettings(const OwnValues& own);

/// Register 0x00F while the mode is fault. Its words are in docs/motors/moteus.md.
[[nodiscard]] FaultCode moteusFault(std::uint32_t native) noexcept;
/// Register 0x00F in any other mode: what bounds the output, as LimitFlags.
[[nodiscard]] std::uint32_t moteusLimit(std::uint32_t native) noexcept;

}  // namespace rc10
