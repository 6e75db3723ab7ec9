#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "blackbox/hand_off.hpp"
#include "blackbox/recording.hpp"

namespace rc10::test {

/// A black box without a file: everything stays in its hand-off ring. Two motors, one bus, one module.
class MemoryBox {
 public:
  explicit MemoryBox(std::size_t ring_bytes = std::size_t{1} << 20U) : ring_(ring_bytes) {
    auto& header = head_.header;
    header.ring_offset = blackbox::kRingOffset;
    header.ring_bytes = ring_bytes;
    header.history_offset = header.ring_offset + ring_bytes;
    header.history_bytes = 64;
    header.file_bytes = header.history_offset + header.history_bytes;
    header.robot = "hero";
    header.program_version = "1.2.3";
    header.pid = 42;
    header.rate_hz = 1000;
    header.bus_count = 1;
    header.buses[0].name = "chassis";
    header.buses[0].interface = "can0";
    header.motor_count = 2;
    header.motors[0].name = "left";
    header.motors[0].model = "M3508";
    header.motors[1].name = "right";
    header.motors[1].model = "M3508";
    header.module_count = 1;
    header.modules[0].name = "base";
    header.modules[0].input_count = 3;
    header.modules[0].inputs[0] = "vx_m_s";
    header.modules[0].inputs[1] = "vy_m_s";
    header.modules[0].inputs[2] = "wz_deg_s";
  }

  [[nodiscard]] blackbox::HandOff handOff() { return {head_.control, ring_}; }
  [[nodiscard]] blackbox::FileHead& head() { return head_; }

  /// The bytes of the file.
  [[nodiscard]] std::vector<std::byte> image() const {
    std::vector<std::byte> bytes(head_.header.file_bytes);
    std::memcpy(bytes.data(), &head_, sizeof head_);
    std::copy(ring_.begin(), ring_.end(),
              bytes.begin() + static_cast<std::ptrdiff_t>(head_.header.ring_offset));
    return bytes;
  }
  [[nodiscard]] blackbox::Recording recording() const { return blackbox::Recording::parse(image()).value(); }

 private:
  blackbox::FileHead head_;
  std::vector<std::byte> ring_;
};

/// The records of one kind, in the order of time.
template <typename T>
std::vector<T> all(const blackbox::Recording& recording) {
  std::vector<T> found;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const auto record = recording.at(i);
    if (const auto* it = std::get_if<T>(&record)) found.push_back(*it);
  }
  return found;
}

/// A classic frame with `number` as its time, in us, and in its payload.
inline blackbox::Frame numberedFrame(std::uint64_t number) {
  blackbox::Frame frame;
  frame.header.time_ns = static_cast<std::int64_t>(number) * 1000;
  frame.header.id = 0x201;
  frame.header.flags = 8;
  std::memcpy(frame.data.data(), &number, sizeof number);
  return frame;
}
inline constexpr std::size_t kNumberedFrameBytes = sizeof(blackbox::RecordHeader) + 8;

inline std::uint64_t numberOf(const blackbox::Frame& frame) {
  std::uint64_t number = 0;
  std::memcpy(&number, frame.data.data(), sizeof number);
  return number;
}

}  // namespace rc10::test
