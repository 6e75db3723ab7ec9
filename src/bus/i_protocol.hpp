#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "app/time.hpp"

namespace rc10 {

/// Statistics of a protocol's decoder since it was built.
struct ProtocolCounters {
  std::uint64_t frames = 0;           ///< Whole and plausible.
  std::uint64_t checksum_errors = 0;  ///< Frames of the right form whose checksum was wrong.
  std::uint64_t resync_bytes = 0;     ///< Bytes that were part of no frame.
};

/// Frames the bytes of one serial device: the injected half of a SerialDevice. A protocol decodes into a
/// latest value of its own type, with the time of its frame. Scheduler thread only: nothing here allocates,
/// throws, waits or asks a clock.
class I_Protocol {
 public:
  I_Protocol() = default;
  I_Protocol(const I_Protocol&) = delete;
  I_Protocol& operator=(const I_Protocol&) = delete;
  virtual ~I_Protocol() = default;

  /// Takes bytes that arrived together at `received`; calls come in the order of time. A frame may begin and
  /// end anywhere in any call, and garbage may stand anywhere. A frame has the time of its last byte.
  virtual void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept = 0;

  /// Writes the frame around `payload` to `out` and returns its length; 0 if the protocol has no such frame,
  /// or if it does not fit.
  [[nodiscard]] virtual std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                               std::span<std::uint8_t> out) const noexcept = 0;

  /// The port was opened anew: forgets the part of a frame that has come. Values and counters stay.
  virtual void restart() noexcept = 0;

  [[nodiscard]] const ProtocolCounters& counters() const noexcept { return counters_; }

 protected:
  ProtocolCounters counters_;
};

}  // namespace rc10
