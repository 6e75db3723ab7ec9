#include "daemon/interfaces/rx_loop.hpp"

#include <sys/epoll.h>

#include <cerrno>
#include <cstring>
#include <span>

#include <fmt/format.h>

#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

// Without traffic the loop turns this often, so that the watchdog sees it alive.
constexpr int kIdleTimeoutMs = 100;
// Further events come with the next call.
constexpr int kMaxRxEvents = 2 * static_cast<int>(kMaxBuses) + 16;

// In the data of an epoll event: the rest is the number of a serial port, not that of a source.
constexpr std::uint64_t kSerialBit = std::uint64_t{1} << 63U;

}  // namespace

RxLoop::RxLoop(Robot& robot, std::span<BusInbox> inboxes, SerialChannels* serial, UniqueFd epoll)
    : inboxes_(inboxes), serial_(serial), epoll_(std::move(epoll)) {
  for (std::size_t i = 0; i < robot.buses().size(); ++i) {
    const auto& entry = robot.buses()[i];
    sources_.push_back({i, false, entry.bus->descriptor(), CanReceiver{entry.bus->descriptor()}});
    if (!entry.echo) continue;
    sources_.push_back({i, true, entry.echo.get(), CanReceiver{entry.echo.get()}});
    inboxes_[i].echo_available.store(true);
  }
}

Result<std::unique_ptr<RxLoop>> RxLoop::create(Robot& robot, std::span<BusInbox> inboxes,
                                               SerialChannels* serial) {
  UniqueFd epoll{epoll_create1(EPOLL_CLOEXEC)};
  if (!epoll) return fail(fmt::format("epoll_create1: {}", std::strerror(errno)));
  auto loop = std::unique_ptr<RxLoop>(new RxLoop(robot, inboxes, serial, std::move(epoll)));
  for (std::size_t i = 0; i < loop->sources_.size(); ++i) {
    if (!loop->watch(i)) return fail(fmt::format("epoll_ctl: {}", std::strerror(errno)));
  }
  return loop;
}

bool RxLoop::watch(std::size_t source) noexcept {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = source;
  return epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, sources_[source].fd, &event) == 0 || errno == EEXIST;
}

bool RxLoop::watchAgain(std::size_t bus) noexcept {
  bool all = true;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (sources_[i].bus == bus) all = watch(i) && all;
  }
  return all;
}

bool RxLoop::watchSerial(std::size_t channel) noexcept {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = kSerialBit | channel;
  return epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, (*serial_)[channel].fd.get(), &event) == 0;
}

void RxLoop::run(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) poll(kIdleTimeoutMs);
}

WakeUp RxLoop::sampleWakeUp() noexcept {
  WakeUp wake{};
  wake.now = monotonicNow();
  wake.realtime_offset = realtimeOffset();
  const bool first = last_wake_.now == MonotonicTime{};
  wake.previous = first ? wake.now : last_wake_.now;
  wake.previous_offset = first ? wake.realtime_offset : last_wake_.realtime_offset;
  last_wake_ = wake;
  return wake;
}

void RxLoop::poll(int timeout_ms) noexcept {
  std::array<epoll_event, kMaxRxEvents> events;
  const int count = epoll_wait(epoll_.get(), events.data(), kMaxRxEvents, timeout_ms);
  wake_ups_.fetch_add(1, std::memory_order_relaxed);
  if (count <= 0) return;
  const WakeUp wake = sampleWakeUp();
  for (const epoll_event& event : std::span(events).first(static_cast<std::size_t>(count))) {
    const std::uint64_t source = event.data.u64;
    if ((source & kSerialBit) != 0) {
      receiveSerial(source & ~kSerialBit, wake.now, event.events);
    } else {
      receive(sources_[source], wake, event.events);
    }
  }
}

void RxLoop::receiveSerial(std::size_t channel, MonotonicTime now, std::uint32_t events) noexcept {
  auto& port = (*serial_)[channel];
  const bool hung_up = (events & (EPOLLHUP | EPOLLERR)) != 0;
  if (receiveChunk(port, now, hung_up)) return;
  // A hang-up is shown for as long as it is watched. And first this: from leavePort() on another port may
  // take the descriptor.
  (void)epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, port.fd.get(), nullptr);
  leavePort(port);
}

void RxLoop::receive(Source& source, const WakeUp& wake, std::uint32_t events) noexcept {
  auto& inbox = inboxes_[source.bus];
  const Reception reception = source.receiver.receive(wake, batch_);
  // The far end of a simulated bus was closed, which is shown for as long as it is watched: the loop would
  // never wait again. watchAgain() takes it back.
  if (reception.error == ENODEV && (events & EPOLLHUP) != 0)
    (void)epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, source.fd, nullptr);
  if (source.echo) {
    inbox.confirmed.fetch_add(reception.confirmed_count, std::memory_order_relaxed);
    return;
  }
  if (reception.error == ENETDOWN) inbox.link.store(CanLinkState::kDown, std::memory_order_relaxed);
  if (reception.error == ENODEV) inbox.link.store(CanLinkState::kGone, std::memory_order_relaxed);
  inbox.malformed.fetch_add(reception.malformed_count, std::memory_order_relaxed);
  std::uint64_t dropped = reception.frame_count - inbox.frames.push(batch_.data(), reception.frame_count);
  // Smaller than before: a new socket, which counts from zero.
  const bool same_socket = reception.kernel_dropped >= source.kernel_dropped;
  dropped += reception.kernel_dropped - (same_socket ? source.kernel_dropped : 0);
  source.kernel_dropped = reception.kernel_dropped;
  if (dropped != 0) inbox.dropped.fetch_add(dropped, std::memory_order_relaxed);
}

}  // namespace rc10
