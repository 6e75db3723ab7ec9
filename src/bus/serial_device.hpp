#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "app/time.hpp"
#include "bus/byte_sink.hpp"
#include "bus/i_protocol.hpp"
#include "bus/serial_chunk.hpp"

namespace rc10 {

enum class SerialState : std::uint8_t {
  kAbsent = 0,  ///< Not there, or not to be opened; it is tried again and again.
  kOpen = 1,
};

struct SerialCounters {
  std::uint64_t bytes_in = 0;
  std::uint64_t chunks = 0;
  std::uint64_t dropped_chunks = 0;  ///< The ring was full: the scheduler did not run.
  std::uint64_t bytes_out = 0;       ///< Handed over to be written.
  std::uint64_t refused_bytes = 0;   ///< Not sent: the port is absent, or the queue is full.
};

/// A byte port with a name and an injected protocol. Scheduler thread only; it neither reads nor writes:
/// chunks come through receive(), and what is sent goes to a sink.
class SerialDevice {
 public:
  /// `sink` outlives the device.
  SerialDevice(std::string name, std::unique_ptr<I_Protocol> protocol, ByteSink& sink)
      : name_(std::move(name)), protocol_(std::move(protocol)), sink_(sink) {}

  [[nodiscard]] std::string_view name() const noexcept { return name_; }
  [[nodiscard]] I_Protocol& protocol() noexcept { return *protocol_; }
  [[nodiscard]] const I_Protocol& protocol() const noexcept { return *protocol_; }

  /// Gives the chunk to the protocol.
  void receive(const SerialChunk& chunk) noexcept;
  /// Sends bytes as they are. False: refused, counted, and none of them leaves.
  bool send(std::span<const std::uint8_t> bytes) noexcept;
  /// Sends the protocol's frame around `payload`. False: no such frame, or refused.
  bool sendFrame(std::span<const std::uint8_t> payload) noexcept;

  /// Bytes that wait to be written: the line is slower than what is sent.
  [[nodiscard]] std::size_t pendingBytes() const noexcept { return sink_.pending(); }

  void setState(SerialState state) noexcept { state_ = state; }
  [[nodiscard]] SerialState state() const noexcept { return state_; }
  /// All the chunks that were dropped on the way here since the start.
  void setDroppedChunks(std::uint64_t count) noexcept { counters_.dropped_chunks = count; }
  [[nodiscard]] const SerialCounters& counters() const noexcept { return counters_; }

  /// When the latest chunk was read; meaningless before the first.
  [[nodiscard]] MonotonicTime lastReceived() const noexcept { return last_received_; }
  /// Silence, frame or not. Duration::max() if nothing ever has.
  [[nodiscard]] Duration age(MonotonicTime now) const noexcept;

 private:
  static constexpr std::size_t kLongestFrame = 256;

  std::string name_;
  std::unique_ptr<I_Protocol> protocol_;
  ByteSink& sink_;
  SerialState state_ = SerialState::kAbsent;
  std::uint32_t opening_ = 0;
  MonotonicTime last_received_;
  SerialCounters counters_;
};

}  // namespace rc10
