#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rc10 {

/// Where a serial device's outgoing bytes go: a bounded queue of the daemon, or a test's.
class ByteSink {
 public:
  ByteSink() = default;
  ByteSink(const ByteSink&) = delete;
  ByteSink& operator=(const ByteSink&) = delete;
  virtual ~ByteSink() = default;

  /// Takes all the bytes, in order, or none of them: half a frame is worth nothing. Never waits.
  [[nodiscard]] virtual bool push(std::span<const std::uint8_t> bytes) noexcept = 0;
  /// Bytes that were taken and have not been handed to the port yet.
  [[nodiscard]] virtual std::size_t pending() const noexcept = 0;
};

}  // namespace rc10
