#include "client/motion/motion_session.hpp"

#include <algorithm>
#include <string>

#include "client/daemon_log.hpp"
#include "client/request_call.hpp"
#include "client/state_text.hpp"

namespace rc10::client {

MotionSession::MotionSession(LinkClient& rc10d, MotionRun& run, std::int32_t priority)
    : rc10d_(rc10d), run_(run), buffer_(link::kMaxMessageSize) {
  command_.client = run.settings().client;
  command_.session = randomSession();
  command_.priority = priority;
  command_.setpoint_count = 1;
  command_.setpoints[0].motor = run.settings().motor;
  auto choice = run_.choice();
  (void)rc10d_.send(choice);
}

void MotionSession::receive() {
  for (;;) {
    const auto received = rc10d_.receive(buffer_);
    if (received.status == LinkClient::ReceiveStatus::kClosed)
      return run_.end(Criterion::kConnection, std::string("rc10d has ended: ").append(kSeeItsLog));
    if (received.status == LinkClient::ReceiveStatus::kNothing) return;
    take(received.datagram);
  }
}

void MotionSession::take(std::span<const std::byte> datagram) {
  if (link::open(datagram, trace_)) {
    run_.take(trace_);
  } else if (link::open(datagram, state_)) {
    const bool known = run_.motor() < state_.motor_count;
    acting_ = known ? state_.motors[run_.motor()].acting : Acting::kNothing;
    held_ = known && state_.motors[run_.motor()].owner.view() == command_.client.view();
    run_.take(state_);
  } else if (link::Event event; link::open(datagram, event)) {
    run_.take(event);
  }
}

// One that is lost is followed by another, or lapses.
void MotionSession::send(MonotonicTime now, MonotonicTime until) {
  const auto order = run_.order(now);
  if (!order) return;
  const auto left_ms = std::chrono::duration_cast<std::chrono::milliseconds>(until - now).count();
  if (left_ms < 1) return;
  command_.setpoints[0].target = order->target;
  command_.validity_ms = static_cast<std::int32_t>(std::min<std::int64_t>(order->validity_ms, left_ms));
  command_.received_ns = 0;  // the present time
  ++command_.seq;
  (void)rc10d_.send(command_);
}

const char* MotionSession::whatMotorDoes() const noexcept {
  return held_ ? "is let go as soon as rc10d goes on" : whatActs(acting_);
}

}  // namespace rc10::client
