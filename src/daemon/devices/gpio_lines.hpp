#pragma once

#include <memory>
#include <string>

#include "app/result.hpp"
#include "config/gpio_config.hpp"
#include "daemon/devices/gpio.hpp"
#include "module/device_needs.hpp"

namespace rc10 {

/// Takes the line as an input with both edges; without waiting, where the chip has no interrupts. The error
/// says what is wrong (chip, rights, line in use) and what to do. Main thread only.
[[nodiscard]] Result<std::unique_ptr<ContactInput>> openContact(const ContactGpioConfig& config,
                                                                const char* key = "estop_gpio");

/// Takes the line as an output, low.
[[nodiscard]] Result<std::unique_ptr<DigitalOutput>> openPulse(const HeartbeatGpioConfig& config);

/// Takes lines for modules. Tests have one without a kernel. The lines thread's only: it allocates.
class GpioSystem {
 public:
  GpioSystem() = default;
  GpioSystem(const GpioSystem&) = delete;
  GpioSystem& operator=(const GpioSystem&) = delete;
  virtual ~GpioSystem() = default;

  /// `user`: a name for messages and for `gpioinfo`. The line stays held as long as what is returned lives.
  [[nodiscard]] virtual Result<std::unique_ptr<DigitalInput>> openInput(const std::string& user,
                                                                        const GpioPin& pin,
                                                                        GpioBias bias) = 0;
  /// The line has the level `high` from the moment on in which it becomes an output.
  [[nodiscard]] virtual Result<std::unique_ptr<DigitalOutput>> openOutput(const std::string& user,
                                                                          const GpioPin& pin, bool high) = 0;
};

/// The kernel's, through libgpiod.
[[nodiscard]] std::unique_ptr<GpioSystem> kernelGpio();

}  // namespace rc10
