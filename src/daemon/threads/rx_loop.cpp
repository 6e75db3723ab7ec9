#include "daemon/threads/rx_loop.hpp"

#include <poll.h>
#include <sys/epoll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>

#include <fmt/format.h>

#include "app/errno_text.hpp"
#include "app/timespec.hpp"
#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

// Without traffic the loop turns this often, so that the watchdog sees it alive.
constexpr Duration kIdle = std::chrono::milliseconds{100};
// Further events come with the next call.
constexpr int kMaxEvents = 16;

}  // namespace

Result<std::unique_ptr<RxLoop>> RxLoop::create(SerialChannels* serial, std::optional<Drain> drain) {
  UniqueFd epoll{epoll_create1(EPOLL_CLOEXEC)};
  if (!epoll) return fail(fmt::format("epoll_create1: {}", errnoText(errno)));
  return std::unique_ptr<RxLoop>(new RxLoop(serial, drain, std::move(epoll)));
}

bool RxLoop::watchSerial(std::size_t channel) noexcept {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = channel;
  return epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, (*serial_)[channel].fd.get(), &event) == 0;
}

void RxLoop::run(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    const MonotonicTime next = turn(monotonicNow());
    poll(next - monotonicNow());  // a long drain must not put off the next one
  }
}

MonotonicTime RxLoop::turn(MonotonicTime now) noexcept {
  if (!drain_) return now + kIdle;
  if (next_drain_ == MonotonicTime{}) next_drain_ = drain_->grid.next(now);
  if (now >= next_drain_) {
    drain_->intake.drain(now);
    next_drain_ += drain_->grid.period * ((now - next_drain_) / drain_->grid.period + 1);
  }
  return next_drain_;
}

void RxLoop::poll(Duration patience) noexcept {
  // ppoll and not a timerfd in the epoll set: on PREEMPT_RT its timer expires in interrupt context for a
  // real-time thread, while a timerfd waits for ktimers (FIFO 1).
  patience = std::clamp(patience, Duration::zero(), kIdle);
  const timespec at_most = toTimespec(patience);
  pollfd ports{.fd = epoll_.get(), .events = POLLIN, .revents = 0};
  const int ready = ::ppoll(&ports, 1, &at_most, nullptr);
  wake_ups_.fetch_add(1, std::memory_order_relaxed);
  if (ready <= 0) return;
  std::array<epoll_event, kMaxEvents> events;
  const int count = epoll_wait(epoll_.get(), events.data(), kMaxEvents, 0);
  if (count <= 0) return;
  const MonotonicTime now = monotonicNow();
  for (const epoll_event& event : std::span(events).first(static_cast<std::size_t>(count)))
    receiveSerial(event.data.u64, now, event.events);
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

}  // namespace rc10
