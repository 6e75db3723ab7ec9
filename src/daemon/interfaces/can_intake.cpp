#include "daemon/interfaces/can_intake.hpp"

#include <cerrno>

#include "daemon/exchange/clock.hpp"

namespace rc10 {

CanIntake::CanIntake(Robot& robot, std::span<BusInbox> inboxes, MonotonicTime now) : inboxes_(inboxes) {
  last_wake_.now = now;
  last_wake_.realtime_offset = realtimeOffset(monotonicNow());
  for (std::size_t i = 0; i < robot.buses().size(); ++i) {
    const auto& entry = robot.buses()[i];
    sources_.push_back({i, CanReceiver{entry.bus->descriptor()}});
    if (!entry.echo) continue;
    echoes_.push_back({i, EchoCounter{entry.echo.get()}});
    inboxes_[i].echo_reads.store(1);
  }
}

void CanIntake::drain(MonotonicTime now) noexcept {
  const WakeUp wake{.now = now,
                    .previous = last_wake_.now,
                    .realtime_offset = realtimeOffset(now),
                    .previous_offset = last_wake_.realtime_offset};
  last_wake_ = wake;
  for (Source& source : sources_) drain(source, wake);
  for (Echoes& echoes : echoes_) drain(echoes);
}

void CanIntake::drain(Source& source, const WakeUp& wake) noexcept {
  for (int reads = 0; reads < kMaxReads; ++reads) {
    const Reception reception = source.receiver.receive(wake, batch_);
    take(source, reception);
    if (reception.frame_count + reception.malformed_count < CanReceiver::kBatch) return;
  }
}

void CanIntake::drain(Echoes& echoes) noexcept {
  for (int reads = 0; reads < kMaxReads; ++reads) {
    const auto count = echoes.counter.take();
    if (count.confirmed != 0)
      inboxes_[echoes.bus].confirmed.fetch_add(count.confirmed, std::memory_order_relaxed);
    if (count.messages < EchoCounter::kBatch) break;
  }
  inboxes_[echoes.bus].echo_reads.fetch_add(1, std::memory_order_release);
}

void CanIntake::take(const Source& source, const Reception& reception) noexcept {
  auto& inbox = inboxes_[source.bus];
  if (reception.error == ENETDOWN) inbox.link.store(CanLinkState::kDown, std::memory_order_relaxed);
  if (reception.error == ENODEV) inbox.link.store(CanLinkState::kGone, std::memory_order_relaxed);
  if (reception.malformed_count != 0)
    inbox.malformed.fetch_add(reception.malformed_count, std::memory_order_relaxed);
  const std::uint64_t dropped = reception.kernel_dropped + reception.frame_count -
                                inbox.frames.push(batch_.data(), reception.frame_count);
  if (dropped != 0) inbox.dropped.fetch_add(dropped, std::memory_order_relaxed);
}

}  // namespace rc10
