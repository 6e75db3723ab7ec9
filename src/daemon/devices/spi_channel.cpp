#include "daemon/devices/spi_channel.hpp"

#include <algorithm>

namespace rc10 {

void handOver(SpiChannel& channel, SpiOutput& output, std::uint32_t& handed_over) noexcept {
  // Relaxed: it says nothing about other memory.
  output.open = channel.open.load(std::memory_order_relaxed);
  if (output.frames == handed_over) return;
  handed_over = output.frames;
  auto& slot = channel.frame.slot();
  slot.number = output.frames;
  slot.size = std::min(output.size, slot.bytes.size());
  std::copy_n(output.bytes.begin(), slot.size, slot.bytes.begin());
  channel.frame.publish();
}

}  // namespace rc10
