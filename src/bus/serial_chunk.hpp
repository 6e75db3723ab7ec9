#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "app/time.hpp"

namespace rc10 {

/// Bytes that one read brought: what crosses from the RX thread to the scheduler.
struct SerialChunk {
  static constexpr std::size_t kCapacity = 240;  // a chunk is 256 bytes

  MonotonicTime received;  ///< When they were read; the kernel does not stamp serial bytes.
  std::uint32_t opening =
      0;  ///< Counts how often the port was opened: bytes of two openings do not belong together.
  std::uint16_t size = 0;
  std::array<std::uint8_t, kCapacity> data{};

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return {data.data(), size}; }
};
static_assert(std::is_trivially_copyable_v<SerialChunk> && sizeof(SerialChunk) == 256);

}  // namespace rc10
