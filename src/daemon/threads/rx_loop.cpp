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
// The socket of e-stops in the epoll set; a serial port has its number.
constexpr std::uint64_t kEstopTag = ~std::uint64_t{0};

}  // namespace

Result<std::unique_ptr<RxLoop>> RxLoop::create(SerialChannels* serial, std::optional<Drain> drain,
                                               std::optional<Estops> estops) {
  UniqueFd epoll{epoll_create1(EPOLL_CLOEXEC)};
  if (!epoll) return fail(fmt::format("epoll_create1: {}", errnoText(errno)));
  auto loop = std::unique_ptr<RxLoop>(new RxLoop(serial, drain, estops, std::move(epoll)));
  if (estops && !loop->watch(estops->datagrams.descriptor(), kEstopTag))
    return fail(fmt::format("the socket of e-stops cannot be watched: epoll_ctl: {}", errnoText(errno)));
  return loop;
}

bool RxLoop::watchSerial(std::size_t channel) noexcept {
  return watch((*serial_)[channel].fd.get(), channel);
}

bool RxLoop::watch(int descriptor, std::uint64_t tag) noexcept {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = tag;
  return epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, descriptor, &event) == 0;
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
  const Duration rest = rests_until_ - monotonicNow();
  const bool rests = rest > Duration::zero();
  patience = std::clamp(rests ? std::min(patience, rest) : patience, Duration::zero(), kIdle);
  const timespec at_most = toTimespec(patience);
  pollfd sources{.fd = epoll_.get(), .events = POLLIN, .revents = 0};
  const int ready = ::ppoll(&sources, rests ? 0 : 1, &at_most, nullptr);
  wake_ups_.fetch_add(1, std::memory_order_relaxed);
  if (ready > 0) look(monotonicNow());
}

void RxLoop::look(MonotonicTime now) noexcept {
  if (now < rests_until_) return;
  std::array<epoll_event, kMaxEvents> events;
  const int count = epoll_wait(epoll_.get(), events.data(), kMaxEvents, 0);
  if (count <= 0) return;
  rests_until_ = now + kRest;
  for (const epoll_event& event : std::span(events).first(static_cast<std::size_t>(count))) {
    if (event.data.u64 != kEstopTag) {
      receiveSerial(event.data.u64, now, event.events);
    } else if (estops_) {
      receiveEstops(*estops_);
    }
  }
}

void RxLoop::receiveEstops(const Estops& estops) noexcept {
  const auto client = estops.datagrams.take();
  if (!client) return;
  auto& exchange = estops.exchange;
  exchange.estop_datagram_client.slot() = *client;
  exchange.estop_datagram_client.publish();
  exchange.estop_datagram.store(true, std::memory_order_release);
}

void RxLoop::receiveSerial(std::size_t channel, MonotonicTime now, std::uint32_t events) noexcept {
  auto& port = (*serial_)[channel];
  const bool hung_up = (events & (EPOLLHUP | EPOLLERR)) != 0;
  if (receiveChunk(port, now, hung_up)) return;
  // Epoll reports a hang-up on each call as long as the descriptor is registered. Removed before leavePort(),
  // after which another port may get the same descriptor number.
  (void)epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, port.fd.get(), nullptr);
  leavePort(port);
}

}  // namespace rc10
