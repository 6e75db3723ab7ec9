#include "daemon/devices/serial_writer.hpp"

#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "daemon/exchange/clock.hpp"

namespace rc10 {

namespace {

// Most bytes of ours in the driver's queue: an e-stop's safe values wait behind them.
constexpr int kMostInDriver = 256;
constexpr int kLookAgainMs = 2;

[[nodiscard]] bool driverIsFull(int fd) noexcept {
  int queued = 0;
  return ::ioctl(fd, TIOCOUTQ, &queued) == 0 && queued >= kMostInDriver;
}

}  // namespace

SerialWriter::SerialWriter(SerialChannels& channels)
    : channels_(channels), pending_(channels.size()), waits_(channels.size() + 1) {
  waits_.back() = {.fd = channels.wake(), .events = POLLIN, .revents = 0};
}

void SerialWriter::serve(Duration duration) {
  const auto end = monotonicNow() + duration;
  for (;;) {
    flush();
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - monotonicNow());
    if (left.count() <= 0) return;
    auto patience_ms = static_cast<int>(left.count());
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const bool waits = pending_[i].begin < pending_[i].end;
      // poll() reports room at once, although this limit is reached: such a port is looked at again later.
      const bool full = waits && driverIsFull(channels_[i].fd.get());
      if (full) patience_ms = std::min(patience_ms, kLookAgainMs);
      waits_[i] = {.fd = waits && !full ? channels_[i].fd.get() : -1, .events = POLLOUT, .revents = 0};
    }
    (void)::poll(waits_.data(), waits_.size(), patience_ms);
  }
}

void SerialWriter::flush() noexcept {
  // First: what is pushed from here on wakes again.
  eventfd_t pushes = 0;
  (void)::eventfd_read(channels_.wake(), &pushes);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    auto& pending = pending_[i];
    while (write(channels_[i], pending)) {
      pending.begin = 0;
      pending.end = channels_[i].outbox.pop(pending.bytes);
      if (pending.end == 0) break;
    }
  }
}

// True: nothing is pending any more.
bool SerialWriter::write(SerialChannel& channel, Pending& pending) noexcept {
  const bool open = channel.state.load(std::memory_order_acquire) == SerialState::kOpen;
  while (open && pending.begin < pending.end) {
    if (driverIsFull(channel.fd.get())) return false;
    const ssize_t size =
        ::write(channel.fd.get(), pending.bytes.data() + pending.begin, pending.end - pending.begin);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && errno == EAGAIN) return false;
    if (size <= 0) break;  // the RX thread meets the end as well
    pending.begin += static_cast<std::size_t>(size);
  }
  channel.discarded_bytes.fetch_add(pending.end - pending.begin, std::memory_order_relaxed);
  pending.begin = pending.end;
  return true;
}

}  // namespace rc10
