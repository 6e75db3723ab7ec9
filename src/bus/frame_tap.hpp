#pragma once

#include "bus/can_frame.hpp"

namespace rc10 {

/// Sees every frame of a bus as it passes, for recordings. Called by the thread that owns the bus, which
/// must not wait for it.
class FrameTap {
 public:
  FrameTap() = default;
  FrameTap(const FrameTap&) = delete;
  FrameTap& operator=(const FrameTap&) = delete;
  virtual ~FrameTap() = default;

  /// Before it is decoded; error frames too.
  virtual void onReceived(const CanFrame& frame) noexcept = 0;
  /// `accepted`: by the kernel; else it was dropped.
  virtual void onSent(const CanFrame& frame, bool accepted) noexcept = 0;
};

}  // namespace rc10
