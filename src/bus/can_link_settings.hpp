#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "bus/can_link_state.hpp"

namespace rc10 {

/// Settings of a CAN controller in the configuration.
struct CanLinkSettings {
  int bitrate = 0;                 ///< bit/s
  int data_bitrate = 0;            ///< bit/s of CAN FD's data phase; 0: a classic bus.
  double sample_point = 0.0;       ///< Share of the bit, 0 to 1; 0: what the kernel chooses.
  double data_sample_point = 0.0;  ///< The same of the data phase.
};

/// "1000000 bit/s", for FD "1000000 bit/s, data 5000000 bit/s".
[[nodiscard]] std::string bitrates(const CanLinkSettings& wanted);

/// Equal but for the rounding of a driver.
[[nodiscard]] bool sameBitrate(std::uint32_t seen, int wanted) noexcept;

/// No time quanta may lie exactly there. 0 is as good as any.
[[nodiscard]] bool sameSamplePoint(double seen, double wanted) noexcept;

/// A mode of a controller that a robot's bus must not have: frames get lost, or nobody notices that they do.
struct HinderingMode {
  std::uint32_t flag = 0;        ///< CAN_CTRLMODE_…
  std::string_view name;         ///< As `ip link` calls it.
  std::string_view consequence;  ///< Effect on motors.
};

/// The first one that is on; nullptr: none.
[[nodiscard]] const HinderingMode* hinderingMode(const CanLink& link) noexcept;

/// The flags of all that are on.
[[nodiscard]] std::uint32_t hinderingModes(const CanLink& link) noexcept;

/// The first thing that is not as wanted, in words that name the interface; empty: nothing, or there is no
/// controller that could be set up.
[[nodiscard]] std::string wrongSetting(const std::string& interface, const CanLink& link,
                                       const CanLinkSettings& wanted);

/// Command that leads there from the state that was read, for instance
/// "ip link set can0 up type can bitrate 1000000 restart-ms 0".
[[nodiscard]] std::string upCommand(const std::string& interface, const CanLink& link,
                                    const CanLinkSettings& wanted);

/// The same for an interface that is up: nothing can be set while it is. `prefix` goes before each command.
[[nodiscard]] std::string restartCommand(const std::string& interface, const CanLink& link,
                                         const CanLinkSettings& wanted, const std::string& prefix = {});

}  // namespace rc10
