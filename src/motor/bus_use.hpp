#pragma once

#include <string_view>
#include <vector>

#include "bus/can_frame.hpp"
#include "bus/frame_bits.hpp"
#include "bus/frame_listener.hpp"

namespace rc10 {

/// Frames of a drive on its bus, for the check of ids and load before power-on.
struct BusUse {
  struct Stream {
    CanId id;
    FrameShape shape;
    double per_second = 0.0;
  };
  std::vector<FrameFilter> sends;  ///< Every frame that the drive may send.
  std::vector<FrameFilter> obeys;  ///< Every frame that it takes as meant for it.
  /// Those of them that move, brake, enable or stop it: another sender of these commands our drive.
  /// Empty: all. Questions and settings are none. Each lies within one of `obeys`.
  std::vector<FrameFilter> steers;
  std::vector<Stream> feedback;  ///< Its usual traffic while it is enabled.
  std::vector<Stream> commands;
  /// Drives with the same layout may share command frames (four DJI currents in one); empty: shares none.
  std::string_view layout{};
  int slot = 0;  ///< Place of its command in such a frame, from 1; 0: its frames are its own.

  [[nodiscard]] const std::vector<FrameFilter>& steering() const noexcept {
    return steers.empty() ? obeys : steers;
  }
};

}  // namespace rc10
