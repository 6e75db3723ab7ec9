#include "daemon/devices/serial_reviver.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include <fmt/format.h>

#include "app/errno_text.hpp"
#include "bus/serial_port.hpp"

namespace rc10 {

void SerialReviver::check(MonotonicTime now) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    auto& port = ports_[i];
    // Acquire: the RX thread has done with the descriptor.
    const bool there = channels_[i].state.load(std::memory_order_acquire) == SerialState::kOpen;
    if (port.open && !there) release(i, now);
    if (!port.open && port.pace.due(now)) tryToOpen(i, now);
  }
}

// As long as the dead port is held, the kernel does not give its name to the next one.
void SerialReviver::release(std::size_t index, MonotonicTime now) {
  auto& port = ports_[index];
  const auto& channel = channels_[index];
  port.open = false;
  port.pace.lost(now);
  if (const UniqueFd nothing{::open("/dev/null", O_RDWR | O_CLOEXEC)}; nothing) {
    (void)::dup3(nothing.get(), channel.fd.get(), O_CLOEXEC);
  }
  notes_.tell(channel.settings.name, Severity::kWarning, fmt::format("{} is gone", channel.settings.path),
              now);
}

void SerialReviver::tryToOpen(std::size_t index, MonotonicTime now) {
  auto& port = ports_[index];
  auto& channel = channels_[index];
  port.pace.begin(now);
  if (const auto opened = open(channel, index); !opened) {
    if (port.pace.failed(opened.error().message))
      notes_.tell(channel.settings.name, Severity::kWarning, opened.error().message, now);
    return;
  }
  port.open = true;
  port.pace.opened(now);
  const auto steady = steadySerialName(channel.settings.path);
  notes_.tell(channel.settings.name, Severity::kInfo,
              fmt::format("{} is open, {}{}", channel.settings.path, channel.settings.format.text(),
                          steady.empty() ? "" : "; its steady name is " + steady),
              now);
}

Result<void> SerialReviver::open(SerialChannel& channel, std::size_t index) {
  const auto port = openSerialPort(channel.settings.path, channel.settings.format);
  if (!port) return tl::unexpected(port.error());
  if (::dup3(port->get(), channel.fd.get(), O_CLOEXEC) < 0) {
    return fail(fmt::format("serial port '{}': dup3: {}", channel.settings.path, errnoText(errno)));
  }
  channel.opening.fetch_add(1, std::memory_order_relaxed);
  channel.state.store(SerialState::kOpen, std::memory_order_release);
  if (watch_(index)) return {};
  channel.state.store(SerialState::kAbsent, std::memory_order_relaxed);
  return fail(fmt::format("serial port '{}': epoll_ctl: {}", channel.settings.path, errnoText(errno)));
}

}  // namespace rc10
