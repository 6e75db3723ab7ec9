#include "bus/serial_device.hpp"

#include <algorithm>
#include <array>

namespace rc10 {

void SerialDevice::receive(const SerialChunk& chunk) noexcept {
  if (chunk.opening != opening_) {
    opening_ = chunk.opening;
    protocol_->restart();
  }
  ++counters_.chunks;
  counters_.bytes_in += chunk.size;
  last_received_ = chunk.received;
  protocol_->parse_stream(chunk.bytes(), chunk.received);
}

bool SerialDevice::send(std::span<const std::uint8_t> bytes) noexcept {
  if (state_ != SerialState::kOpen || !sink_.push(bytes)) {
    counters_.refused_bytes += bytes.size();
    return false;
  }
  counters_.bytes_out += bytes.size();
  return true;
}

bool SerialDevice::sendFrame(std::span<const std::uint8_t> payload) noexcept {
  std::array<std::uint8_t, kLongestFrame> frame;
  const std::size_t size = protocol_->pack_frame(payload, frame);
  return size > 0 && send(std::span(frame).first(std::min(size, frame.size())));
}

Duration SerialDevice::age(MonotonicTime now) const noexcept {
  if (counters_.chunks == 0) return Duration::max();
  return now - last_received_;
}

}  // namespace rc10
