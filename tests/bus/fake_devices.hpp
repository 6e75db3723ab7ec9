#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bus/command_packer.hpp"
#include "bus/frame_listener.hpp"

namespace rc10::test {

/// A device that listens to what a test gives it and remembers what it was handed.
class FakeDevice : public FrameListener {
 public:
  FakeDevice(std::string name, std::vector<FrameFilter> filters)
      : name_(std::move(name)), filters_(std::move(filters)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame&) const noexcept override { return matches; }
  FrameVerdict updateFeedback(const CanFrame& frame) noexcept override {
    ++received;
    last = frame;
    return verdict;
  }

  bool matches = true;
  FrameVerdict verdict = FrameVerdict::kAccepted;
  int received = 0;
  CanFrame last;

 private:
  std::string name_;
  std::vector<FrameFilter> filters_;
};

/// Listens to one exact standard id, as a DJI motor does.
inline FrameFilter standardFilter(std::uint32_t id) { return {.id = {id, false}}; }
/// Listens to one exact extended id, as a VESC does.
inline FrameFilter extendedFilter(std::uint32_t id) { return {.id = {id, true}}; }
/// RobStride: type and data vary in the upper bits, the motor id is bits 8-15.
inline FrameFilter robStrideFilter(std::uint32_t motor_id) {
  return {.id = {motor_id << 8U, true}, .mask = 0x0000'FF00U};
}
/// Damiao: all drives answer on the master id, and say who they are in the low nibble of byte 0.
inline FrameFilter damiaoFilter(std::uint32_t master_id, std::uint8_t motor_id) {
  return {.id = {master_id, false},
          .discriminators = {PayloadDiscriminator{.byte_index = 0, .mask = 0x0F, .value = motor_id}}};
}

/// Sends `frames_per_tick` frames with its id; byte 0 is the frame's number in the tick, byte 1 the low
/// byte of the tick's index. Rest frames are all zero.
class FakePacker : public CommandPacker {
 public:
  FakePacker(std::string name, CanId id, std::size_t frames_per_tick = 1)
      : name_(std::move(name)), ids_{id}, frames_per_tick_(frames_per_tick) {}

  [[nodiscard]] std::string_view packerName() const noexcept override { return name_; }
  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return ids_; }

  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override {
    for (std::size_t i = 0; i < frames_per_tick_ && i < out.size(); ++i) {
      const std::array<std::uint8_t, 8> payload{static_cast<std::uint8_t>(i),
                                                static_cast<std::uint8_t>(tick.index)};
      out[i] = fd ? makeFdFrame(ids_[0], payload, true) : makeClassicFrame(ids_[0], payload);
    }
    return frames_per_tick_;
  }

  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override {
    out[0] = makeClassicFrame(ids_[0], std::array<std::uint8_t, 8>{});
    return 1;
  }

  void onUnsent() noexcept override { ++unsent; }

  bool fd = false;
  int unsent = 0;  ///< Calls of onUnsent().

 private:
  std::string name_;
  std::array<CanId, 1> ids_;
  std::size_t frames_per_tick_;
};

}  // namespace rc10::test
