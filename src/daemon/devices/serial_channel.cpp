#include "daemon/devices/serial_channel.hpp"

#include <fcntl.h>
#include <sys/eventfd.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>

#include <fmt/format.h>

#include "app/errno_text.hpp"

namespace rc10 {

bool SerialOutbox::push(std::span<const std::uint8_t> bytes) noexcept {
  if (ring_.write_available() < bytes.size()) return false;
  (void)ring_.push(bytes.data(), bytes.size());
  (void)::eventfd_write(wake_, 1);
  return true;
}

SerialChannel::~SerialChannel() {
  // The kernel would wait half a minute for bytes that nobody takes any more.
  (void)::tcflush(fd.get(), TCOFLUSH);
}

Result<std::unique_ptr<SerialChannels>> SerialChannels::create(
    std::span<const SerialChannel::Settings> ports) {
  UniqueFd wake{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  if (!wake) return fail(fmt::format("eventfd: {}", errnoText(errno)));
  auto channels = std::unique_ptr<SerialChannels>(new SerialChannels(std::move(wake)));
  for (const auto& port : ports) {
    UniqueFd null_device{::open("/dev/null", O_RDWR | O_CLOEXEC)};
    if (!null_device) return fail(fmt::format("serial '{}': /dev/null: {}", port.name, errnoText(errno)));
    channels->channels_.push_back(
        std::make_unique<SerialChannel>(port, std::move(null_device), channels->wake()));
  }
  return channels;
}

bool receiveChunk(SerialChannel& channel, MonotonicTime now, bool hung_up) noexcept {
  SerialChunk chunk;
  const ssize_t size = ::read(channel.fd.get(), chunk.data.data(), chunk.data.size());
  if (size > 0) {
    chunk.received = now;
    chunk.opening = channel.opening.load(std::memory_order_relaxed);
    chunk.size = static_cast<std::uint16_t>(size);
    if (!channel.chunks.push(chunk)) channel.dropped_chunks.fetch_add(1, std::memory_order_relaxed);
    return true;
  }
  return size < 0 && (errno == EAGAIN || errno == EINTR) && !hung_up;
}

void leavePort(SerialChannel& channel) noexcept {
  channel.hang_ups.fetch_add(1, std::memory_order_relaxed);
  // Release: nothing of this thread's use of the descriptor comes after the io thread sees it.
  channel.state.store(SerialState::kAbsent, std::memory_order_release);
}

void deliver(SerialChannel& channel, SerialDevice& device) noexcept {
  // Bytes that arrive meanwhile are for the next tick.
  for (auto left = channel.chunks.read_available(); left > 0; --left) {
    device.receive(channel.chunks.front());
    (void)channel.chunks.pop();
  }
  device.setState(channel.state.load(std::memory_order_relaxed));
  device.setDroppedChunks(channel.dropped_chunks.load(std::memory_order_relaxed));
}

}  // namespace rc10
