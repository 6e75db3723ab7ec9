#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include <boost/lockfree/spsc_queue.hpp>

#include "bus/can_frame.hpp"

namespace rc10 {

/// Frames and questions of the one scan that runs: heard by the scheduler, judged by the link thread. Numbers
/// are those of the order, so that a scan takes nothing of another.
struct BusScanExchange {
  // 50 ms of a full classic bus; the link thread takes them a hundred times a second.
  static constexpr std::size_t kFrames = 1024;
  static constexpr std::size_t kMostQuestions = 512;

  boost::lockfree::spsc_queue<CanFrame, boost::lockfree::capacity<kFrames>> heard;  // scheduler -> link
  std::atomic<std::uint64_t> dropped{0};   ///< By the scheduler: frames for which there was no room.
  std::atomic<std::uint64_t> listened{0};  ///< By the scheduler: of this order the listening is over.
  /// Written by the link thread before `ready`; read by the scheduler after it, until its result of the
  /// order.
  std::array<CanFrame, kMostQuestions> questions{};
  std::size_t question_count = 0;
  std::atomic<std::uint64_t> ready{0};     ///< By the link thread, releases: of this order they are complete.
  std::atomic<std::uint64_t> given_up{0};  ///< By the link thread: nobody waits for this order any more.
};

}  // namespace rc10
