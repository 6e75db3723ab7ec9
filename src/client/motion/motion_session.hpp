#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/time.hpp"
#include "app/vocabulary.hpp"
#include "client/link_client.hpp"
#include "client/motion/motion_run.hpp"

namespace rc10::client {

/// Between a test of motion and a connection with link::kStates and link::kEvents. Nothing waits.
class MotionSession {
 public:
  /// Both must outlive this. Chooses the signals of each tick.
  MotionSession(LinkClient& rc10d, MotionRun& run, std::int32_t priority);

  /// Takes everything that has arrived. The end of rc10d ends the test.
  void receive();
  /// Sends the target that is due. After `until` it is in force no more, and none is sent.
  void send(MonotonicTime now, MonotonicTime until = MonotonicTime::max());

  /// The motor's action by the newest state.
  [[nodiscard]] const char* whatMotorDoes() const noexcept;

 private:
  void take(std::span<const std::byte> datagram);

  LinkClient& rc10d_;
  MotionRun& run_;
  std::vector<std::byte> buffer_;
  link::Command command_;
  link::Trace trace_;
  link::State state_;
  Acting acting_{};
  bool held_ = false;  ///< Its target is in force still.
};

}  // namespace rc10::client
