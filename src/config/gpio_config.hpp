#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "app/time.hpp"

namespace rc10 {

/// One line of a GPIO chip.
struct GpioPin {
  std::string chip;  ///< Name (gpiochip0), path or label (pinctrl-rp1).
  int line = 0;      ///< Offset in the chip.

  /// "gpiochip0:17", for messages.
  [[nodiscard]] std::string name() const { return chip + ":" + std::to_string(line); }
  /// The same for gpiochip0 and /dev/gpiochip0. A label is another name all the same: the kernel would have
  /// to be asked.
  [[nodiscard]] std::string sameName() const {
    constexpr std::string_view kFolder = "/dev/";
    return chip.starts_with(kFolder) ? name().substr(kFolder.size()) : name();
  }
  friend bool operator==(const GpioPin& one, const GpioPin& other) {
    return one.sameName() == other.sameName();
  }
};

/// A contact that is closed while all is well: open, a broken wire and an unreadable chip are one.
struct ContactGpioConfig {
  GpioPin pin;
  bool closed_is_low = true;  ///< The contact goes to ground; else to the supply.
  bool internal_bias = true;  ///< The chip's own resistor pulls an open wire to the other level.
};

/// An output that toggles while the scheduler ticks.
struct HeartbeatGpioConfig {
  GpioPin pin;
  Duration period{std::chrono::milliseconds{20}};  ///< Period of the square wave.
  std::optional<Duration> rests_in_estop_after;    ///< Time after the e-stop; none: it goes on.
};

}  // namespace rc10
