#include "daemon/devices/serial_line.hpp"

#include <fcntl.h>
#include <sys/eventfd.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <fmt/format.h>

namespace rc10 {

bool SerialOutbox::push(std::span<const std::uint8_t> bytes) noexcept {
  if (ring_.write_available() < bytes.size()) return false;
  (void)ring_.push(bytes.data(), bytes.size());
  (void)::eventfd_write(wake_, 1);
  return true;
}

SerialLine::~SerialLine() {
  // The kernel would wait half a minute for bytes that nobody takes any more.
  (void)::tcflush(fd.get(), TCOFLUSH);
}

Result<std::unique_ptr<SerialLines>> SerialLines::create(std::span<const SerialLine::Settings> ports) {
  UniqueFd wake{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  if (!wake) return fail(fmt::format("eventfd: {}", std::strerror(errno)));
  auto lines = std::unique_ptr<SerialLines>(new SerialLines(std::move(wake)));
  for (const auto& port : ports) {
    UniqueFd null_device{::open("/dev/null", O_RDWR | O_CLOEXEC)};
    if (!null_device) return fail(fmt::format("serial '{}': /dev/null: {}", port.name, std::strerror(errno)));
    lines->lines_.push_back(std::make_unique<SerialLine>(port, std::move(null_device), lines->wake()));
  }
  return lines;
}

bool receiveChunk(SerialLine& line, MonotonicTime now, bool hung_up) noexcept {
  SerialChunk chunk;
  const ssize_t size = ::read(line.fd.get(), chunk.data.data(), chunk.data.size());
  if (size > 0) {
    chunk.received = now;
    chunk.opening = line.opening.load(std::memory_order_relaxed);
    chunk.size = static_cast<std::uint16_t>(size);
    if (!line.chunks.push(chunk)) line.dropped_chunks.fetch_add(1, std::memory_order_relaxed);
    return true;
  }
  return size < 0 && (errno == EAGAIN || errno == EINTR) && !hung_up;
}

void leavePort(SerialLine& line) noexcept {
  line.hang_ups.fetch_add(1, std::memory_order_relaxed);
  // Release: nothing of this thread's use of the descriptor comes after the io thread sees it.
  line.state.store(SerialState::kAbsent, std::memory_order_release);
}

void deliver(SerialLine& line, SerialDevice& device) noexcept {
  // Bytes that arrive meanwhile are for the next tick.
  for (auto left = line.chunks.read_available(); left > 0; --left) {
    device.receive(line.chunks.front());
    (void)line.chunks.pop();
  }
  device.setState(line.state.load(std::memory_order_relaxed));
  device.setDroppedChunks(line.dropped_chunks.load(std::memory_order_relaxed));
}

}  // namespace rc10
