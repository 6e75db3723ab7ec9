#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "bus/byte_sink.hpp"
#include "bus/serial_chunk.hpp"
#include "bus/serial_device.hpp"
#include "bus/serial_format.hpp"
#include "daemon/exchange/rings.hpp"

namespace rc10 {

/// Outbox of the scheduler to one serial port: a bounded queue that the io thread writes. Every push wakes
/// it.
class SerialOutbox final : public ByteSink {
 public:
  static constexpr std::size_t kBytes = 4096;  // 0.35 s at 115200 baud

  /// `wake`: an eventfd that lives as long.
  explicit SerialOutbox(int wake) noexcept : wake_(wake) {}

  /// Scheduler thread only. One system call, which does not wait.
  [[nodiscard]] bool push(std::span<const std::uint8_t> bytes) noexcept override;
  /// Scheduler thread only.
  [[nodiscard]] std::size_t pending() const noexcept override { return kBytes - ring_.write_available(); }
  /// io thread only. Returns how many bytes it has written to `out`.
  [[nodiscard]] std::size_t pop(std::span<std::uint8_t> out) noexcept {
    return ring_.pop(out.data(), out.size());
  }

 private:
  Ring<std::uint8_t, kBytes> ring_;
  int wake_;
};

/// One serial port between the RX, io and scheduler threads. The descriptor keeps its number for ever: while
/// the port is absent it is /dev/null, and the io thread puts an opened port in its place.
struct SerialChannel {
  struct Settings {
    std::string name;
    std::string path;
    SerialFormat format{};
  };

  // The RX thread reads what is there: at most a few chunks a millisecond.
  static constexpr std::size_t kChunks = 256;

  SerialChannel(Settings settings_of_port, UniqueFd null_device, int wake)
      : settings(std::move(settings_of_port)), fd(std::move(null_device)), outbox(wake) {}
  SerialChannel(const SerialChannel&) = delete;
  SerialChannel& operator=(const SerialChannel&) = delete;
  ~SerialChannel();

  const Settings settings;
  const UniqueFd fd;
  SerialOutbox outbox;                            ///< scheduler -> io
  Ring<SerialChunk, kChunks> chunks;              ///< rx -> scheduler
  std::atomic<std::uint64_t> dropped_chunks{0};   ///< The ring was full; counted by rx.
  std::atomic<std::uint64_t> hang_ups{0};         ///< Counted by rx.
  std::atomic<std::uint64_t> discarded_bytes{0};  ///< Taken from the outbox and not written; counted by io.
  /// rx says kAbsent when it has met the end, and then leaves the descriptor alone; io says kOpen once
  /// another port is in its place, and only then shows it to rx.
  std::atomic<SerialState> state{SerialState::kAbsent};
  std::atomic<std::uint32_t> opening{0};  ///< Times the port was opened; counted by io.
};

/// All the serial ports of a robot. Built before the threads, and outlives them.
class SerialChannels {
 public:
  /// Opens nothing yet: see SerialReviver.
  [[nodiscard]] static Result<std::unique_ptr<SerialChannels>> create(
      std::span<const SerialChannel::Settings> ports);

  [[nodiscard]] std::size_t size() const noexcept { return channels_.size(); }
  [[nodiscard]] SerialChannel& operator[](std::size_t index) noexcept { return *channels_[index]; }
  /// An eventfd: something was pushed to an outbox.
  [[nodiscard]] int wake() const noexcept { return wake_.get(); }

 private:
  explicit SerialChannels(UniqueFd wake) noexcept : wake_(std::move(wake)) {}

  UniqueFd wake_;
  std::vector<std::unique_ptr<SerialChannel>> channels_;
};

/// RX thread: one read. `hung_up`: as epoll says; what came before is still read. False: the port is gone.
[[nodiscard]] bool receiveChunk(SerialChannel& channel, MonotonicTime now, bool hung_up) noexcept;

/// RX thread: the port is gone, and this thread does not touch the descriptor until it is told to watch it
/// again.
void leavePort(SerialChannel& channel) noexcept;

/// Scheduler thread: gives the device what has come until now, and tells it the port's state.
void deliver(SerialChannel& channel, SerialDevice& device) noexcept;

}  // namespace rc10
