#include "daemon/devices/serial_writer.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "daemon/exchange/clock.hpp"

namespace rc10 {

SerialWriter::SerialWriter(SerialLines& lines)
    : lines_(lines), pending_(lines.size()), waits_(lines.size() + 1) {
  waits_.back() = {.fd = lines.wake(), .events = POLLIN, .revents = 0};
}

void SerialWriter::serve(Duration duration) {
  const auto end = monotonicNow() + duration;
  for (;;) {
    flush();
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - monotonicNow());
    if (left.count() <= 0) return;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const bool waits = pending_[i].begin < pending_[i].end;
      waits_[i] = {.fd = waits ? lines_[i].fd.get() : -1, .events = POLLOUT, .revents = 0};
    }
    (void)::poll(waits_.data(), waits_.size(), static_cast<int>(left.count()));
  }
}

void SerialWriter::flush() noexcept {
  // First: what is pushed from here on wakes again.
  eventfd_t pushes = 0;
  (void)::eventfd_read(lines_.wake(), &pushes);
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    auto& pending = pending_[i];
    while (write(lines_[i], pending)) {
      pending.begin = 0;
      pending.end = lines_[i].outbox.pop(pending.bytes);
      if (pending.end == 0) break;
    }
  }
}

// True: nothing is pending any more.
bool SerialWriter::write(SerialLine& line, Pending& pending) noexcept {
  const bool open = line.state.load(std::memory_order_acquire) == SerialState::kOpen;
  while (open && pending.begin < pending.end) {
    const ssize_t size =
        ::write(line.fd.get(), pending.bytes.data() + pending.begin, pending.end - pending.begin);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && errno == EAGAIN) return false;
    if (size <= 0) break;  // the RX thread meets the end as well
    pending.begin += static_cast<std::size_t>(size);
  }
  line.discarded_bytes.fetch_add(pending.end - pending.begin, std::memory_order_relaxed);
  pending.begin = pending.end;
  return true;
}

}  // namespace rc10
