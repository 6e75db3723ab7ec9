#pragma once

#include <cstdint>

namespace rc10 {

/// Kind of frame that the supervisor orders for a drive in this tick.
enum class FrameKind : std::uint8_t {
  kRest,     ///< No torque.
  kPoll,     ///< No torque, but answer: for drives that speak only when asked.
  kIdle,     ///< Enabled, without a target.
  kDamp,     ///< Resist motion gently, in proportion to the speed.
  kBrake,    ///< Stop and resist being moved.
  kHold,     ///< Stay at the angle where the hold began.
  kEnable,   ///< The next step of the enable sequence.
  kDisable,  ///< The next step of the disable sequence.
  kCommand,  ///< Follow the target.
};

/// State of a drive for as long as it is told a kind of frame.
enum class DriveDuty : std::uint8_t {
  kRest,    ///< Nobody expects anything of it.
  kEnable,  ///< Its enable sequence runs.
  kObey,    ///< It follows what it is told; a drive that has stopped by itself is a fault.
};

/// The one place where a new kind is put.
[[nodiscard]] constexpr DriveDuty dutyOf(FrameKind kind) noexcept {
  switch (kind) {
    case FrameKind::kRest:
    case FrameKind::kPoll:
    case FrameKind::kDisable: break;
    case FrameKind::kEnable: return DriveDuty::kEnable;
    case FrameKind::kIdle:
    case FrameKind::kDamp:
    case FrameKind::kBrake:
    case FrameKind::kHold:
    case FrameKind::kCommand: return DriveDuty::kObey;
  }
  return DriveDuty::kRest;
}

/// Provision of one kind of frame by a family.
enum class Provision : std::uint8_t {
  kUnsupported,  ///< It cannot; asking for it in the configuration is an error.
  kNothing,      ///< Nothing needs to be sent: the kind is fulfilled at once.
  kFrame,        ///< A frame of the drive's own protocol.
  kHostLoop,     ///< Computed by the host's loops; needs fresh feedback, else rest is sent.
};

/// One row per family: what it sends for each kind. `rest` is never unsupported.
struct DriveFrames {
  Provision rest = Provision::kFrame;
  Provision poll = Provision::kNothing;
  Provision idle = Provision::kFrame;
  Provision damp = Provision::kUnsupported;
  Provision brake = Provision::kUnsupported;
  Provision hold = Provision::kUnsupported;
  Provision enable = Provision::kNothing;
  Provision disable = Provision::kNothing;
  bool idle_rests = true;      ///< While it is enabled without a target it has no torque.
  bool brake_resists = false;  ///< Its brake can only oppose motion: no loop of a speed or a place.

  [[nodiscard]] constexpr Provision of(FrameKind kind) const noexcept {
    switch (kind) {
      case FrameKind::kRest: return rest;
      case FrameKind::kPoll: return poll;
      case FrameKind::kIdle: return idle;
      case FrameKind::kDamp: return damp;
      case FrameKind::kBrake: return brake;
      case FrameKind::kHold: return hold;
      case FrameKind::kEnable: return enable;
      case FrameKind::kDisable: return disable;
      case FrameKind::kCommand: return Provision::kFrame;
    }
    return Provision::kUnsupported;
  }
};

/// An action of this kind can only oppose motion, never cause it.
[[nodiscard]] constexpr bool resists(FrameKind kind, const DriveFrames& frames) noexcept {
  return kind == FrameKind::kDamp ||
         (kind == FrameKind::kBrake && frames.brake_resists && frames.brake != Provision::kUnsupported);
}

/// Progress of the enable or disable sequence.
enum class SequenceProgress : std::uint8_t { kDone, kPending, kFailed };

}  // namespace rc10
