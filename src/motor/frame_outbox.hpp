#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "bus/command_packer.hpp"

namespace rc10 {

/// Frames that are to leave with the next packCommand(), in order; what there is no room for stays out.
class FrameOutbox {
 public:
  void clear() noexcept { count_ = 0; }
  void add(const CanFrame& frame) noexcept {
    if (count_ < frames_.size()) frames_[count_++] = frame;
  }
  /// Number for which there was room.
  std::size_t copyTo(std::span<CanFrame> out) const noexcept {
    const std::size_t count = std::min(count_, out.size());
    std::copy_n(frames_.begin(), count, out.begin());
    return count;
  }

 private:
  std::array<CanFrame, kMaxFramesPerPacker> frames_{};
  std::size_t count_ = 0;
};

}  // namespace rc10
