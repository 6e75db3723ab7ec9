#include "daemon/tick/bus_watch.hpp"

#include <algorithm>
#include <cerrno>

namespace rc10 {
namespace {

// A stalled bus gets its rest frames this often: if nothing is left in the kernel's queue, only the echo of
// a new frame shows that the bus is back.
constexpr Duration kProbeInterval = std::chrono::milliseconds{50};
// A second controller sends a thousand frames a second: they are reported together.
constexpr Duration kForeignReportInterval = std::chrono::seconds{1};

}  // namespace

void BusWatch::decide(const Tick& tick) noexcept {
  for (std::size_t i = 0, count = robot_.buses().size(); i < count; ++i) {
    auto& entry = robot_.buses()[i];
    reportState(i, tick);  // before the events of its motors, which follow from it
    entry.held = !carriesFrames(entry.bus->health().state());
  }
}

void BusWatch::send(const Tick& tick, bool stopping) noexcept {
  for (std::size_t i = 0, count = robot_.buses().size(); i < count; ++i) {
    auto& bus = *robot_.buses()[i].bus;
    if (robot_.buses()[i].held && !stopping) {
      bus.holdBack();
      if (bus.health().state() == BusState::kStalled) probe(i, tick);
      continue;
    }
    bus.flush();
    // The kernel reports a lost interface once, to whoever asks first: a receive may not see it.
    if (bus.sendError() == ENETDOWN) {
      auto expected = CanLinkState::kUp;  // never hides that the interface is gone
      inboxes_[i].link.compare_exchange_strong(expected, CanLinkState::kDown, std::memory_order_relaxed);
    }
  }
}

void BusWatch::probe(std::size_t bus, const Tick& tick) noexcept {
  if (tick.now < watched_[bus].next_probe) return;
  watched_[bus].next_probe = tick.now + kProbeInterval;
  robot_.buses()[bus].bus->packRest();
  robot_.buses()[bus].bus->flush();
}

void BusWatch::update(const Tick& tick) noexcept {
  for (std::size_t i = 0, count = robot_.buses().size(); i < count; ++i) {
    updateHealth(i, tick);
    reportState(i, tick);
    reportForeign(i, tick);
  }
}

void BusWatch::updateHealth(std::size_t bus, const Tick& tick) noexcept {
  auto& entry = robot_.buses()[bus];
  auto& inbox = inboxes_[bus];
  auto& watched = watched_[bus];
  auto& health = entry.bus->health();
  const auto& counters = entry.bus->counters();
  health.onLink(inbox.link.load(std::memory_order_relaxed));
  const auto running = inbox.controller_running.load(std::memory_order_relaxed);
  if (running != watched.running_seen) health.onControllerRunning();
  watched.running_seen = running;
  // Before the echoes that it has seen.
  const auto echo_reads = inbox.echo_reads.load(std::memory_order_acquire);
  health.update(tick.now, {.rx_frames = counters.rx_frames,
                           .tx_frames = counters.tx_frames,
                           .tx_watched = counters.tx_watched,
                           .tx_refused = counters.tx_watched_refused,
                           .tx_confirmed = inbox.confirmed.load(std::memory_order_relaxed),
                           .echo_reads = echo_reads,
                           .feedback_expected = entry.feedback_expected});
}

void BusWatch::reportState(std::size_t bus, const Tick& tick) noexcept {
  const auto state = robot_.buses()[bus].bus->health().state();
  if (state != watched_[bus].state) changeState(bus, state, tick);
}

void BusWatch::changeState(std::size_t bus, BusState state, const Tick& tick) noexcept {
  auto& watched = watched_[bus];
  supervisor_.report({EventCode::kBusState, state == BusState::kActive ? Severity::kInfo : Severity::kError,
                      static_cast<std::int16_t>(bus), static_cast<std::int32_t>(state),
                      static_cast<std::int32_t>(watched.state), tick.now});
  if (state == BusState::kStalled) watched.next_probe = tick.now + kProbeInterval;
  watched.state = state;
  inboxes_[bus].state.store(state, std::memory_order_relaxed);
}

void BusWatch::reportForeign(std::size_t bus, const Tick& tick) noexcept {
  auto& watched = watched_[bus];
  const auto count = robot_.buses()[bus].bus->counters().rx_foreign;
  if (count == watched.foreign_reported || tick.now < watched.next_foreign_report) return;
  const auto& last = robot_.buses()[bus].bus->lastForeign();
  const auto news =
      static_cast<std::int32_t>(std::min<std::uint64_t>(count - watched.foreign_reported, INT32_MAX));
  supervisor_.report({EventCode::kForeignSender, Severity::kError, static_cast<std::int16_t>(bus), news,
                      foreignFrame(last.id, last.sent_here), tick.now});
  watched.foreign_reported = count;
  watched.next_foreign_report = tick.now + kForeignReportInterval;
}

}  // namespace rc10
