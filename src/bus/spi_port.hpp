#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"

namespace rc10 {

/// A device that takes bytes over SPI. Of one thread that may wait.
class SpiPort {
 public:
  SpiPort() = default;
  SpiPort(const SpiPort&) = delete;
  SpiPort& operator=(const SpiPort&) = delete;
  virtual ~SpiPort() = default;

  /// Sends all bytes in one transfer, and waits until they are out. 0, or the errno of the refusal.
  [[nodiscard]] virtual int send(std::span<const std::uint8_t> bytes) noexcept = 0;
};

/// ioctl(), or a test's.
using IoctlCall = int (*)(int fd, unsigned long request, void* argument);
[[nodiscard]] int systemIoctl(int fd, unsigned long request, void* argument) noexcept;

/// Opens a spidev device for sending only: mode 0, 8 bits a word, the highest first. Each setting is read
/// back. Main or io thread only: it allocates. The error names the path, the cause and what to do.
[[nodiscard]] Result<std::unique_ptr<SpiPort>> openSpiPort(const std::string& path, std::uint32_t speed_hz,
                                                           IoctlCall ioctl = systemIoctl);

}  // namespace rc10
