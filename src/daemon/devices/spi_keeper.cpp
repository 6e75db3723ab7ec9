#include "daemon/devices/spi_keeper.hpp"

#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace rc10 {

SpiKeeper::SpiKeeper(SpiChannels& channels, LinkExchange& exchange, Open open)
    : channels_(channels),
      notes_(exchange.notes, EventCode::kDevice),
      open_(std::move(open)),
      devices_(channels.size()) {}

void SpiKeeper::turn(MonotonicTime now) {
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    if (!devices_[i].port && devices_[i].pace.due(now)) open(i, now);
    if (devices_[i].port) serve(i, now);
  }
}

void SpiKeeper::open(std::size_t index, MonotonicTime now) {
  auto& device = devices_[index];
  auto& channel = *channels_[index];
  device.pace.begin(now);
  auto opened = open_(channel.settings.path, channel.settings.speed_hz);
  if (!opened) {
    if (device.pace.failed(opened.error().message))
      notes_.tell(channel.settings.name, Severity::kWarning, opened.error().message, now);
    return;
  }
  // Its present state is unknown: the newest frame is sent, even if it was sent before.
  device = {.port = std::move(*opened), .pace = device.pace};
}

void SpiKeeper::serve(std::size_t index, MonotonicTime now) {
  auto& device = devices_[index];
  auto& channel = *channels_[index];
  const auto error = sendNewest(channel, device);
  if (!error) return;
  if (*error != 0) return fail(index, *error, now);
  if (std::exchange(device.works, true)) return;
  device.pace.opened(now);
  channel.open.store(true, std::memory_order_relaxed);
  notes_.tell(channel.settings.name, Severity::kInfo,
              fmt::format("{} works, at {} Hz", channel.settings.path, channel.settings.speed_hz), now);
}

void SpiKeeper::fail(std::size_t index, int error, MonotonicTime now) {
  auto& device = devices_[index];
  auto& channel = *channels_[index];
  device.port.reset();
  if (device.works) device.pace.lost(now);
  channel.open.store(false, std::memory_order_relaxed);
  auto text = fmt::format("SPI device '{}': cannot send: {}", channel.settings.path, std::strerror(error));
  if (error == EMSGSIZE)
    text += "; its buffer is too small: add spidev.bufsiz=4096 to the kernel's command line";
  if (device.pace.failed(text)) notes_.tell(channel.settings.name, Severity::kWarning, text, now);
}

std::optional<int> SpiKeeper::sendNewest(SpiChannel& channel, Device& device) noexcept {
  const auto& frame = channel.frame.read();
  if (frame.number != device.sent) {
    device.sent = frame.number;
    device.silent_turns = 0;
    device.rests = false;
    return device.port->send(std::span{frame.bytes}.first(frame.size));
  }
  if (device.rests || ++device.silent_turns < kSilentTurns) return std::nullopt;
  device.rests = true;
  return device.port->send(channel.settings.rest);
}

void SpiKeeper::end() noexcept {
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    if (devices_[i].port) (void)devices_[i].port->send(channels_[i]->settings.rest);
  }
}

}  // namespace rc10
