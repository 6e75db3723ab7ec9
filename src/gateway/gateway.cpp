#include "gateway/gateway.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "app/printable.hpp"

namespace rc10::gateway {
namespace {

// Most that one wake-up takes from one side before the other has its turn.
constexpr int kMaxDatagrams = 256;
constexpr int kMaxLinkMessages = 64;

constexpr Duration kFirstPause = std::chrono::seconds{1};
constexpr Duration kLongestPause = std::chrono::seconds{10};
constexpr Duration kRouteCheck = std::chrono::seconds{2};

}  // namespace

Gateway::Gateway(LinkClient rc10d, const UdpmUrl& url, StderrLines lines)
    : rc10d_(std::move(rc10d)),
      url_(url),
      outlet_(rc10d_.welcome(), *this),
      inlet_(rc10d_, outlet_),
      lines_(std::move(lines)),
      link_buffer_(link::kMaxMessageSize) {}

void Gateway::run(const volatile std::sig_atomic_t& stop) {
  while (stop == 0) {
    const ClockSample now = sampleClocks();
    watchTransport(now);
    if (!receiveLcm(now) || !receiveLink()) {
      logOnce("rc10d has ended");
      return;
    }
    waitForWork();
  }
}

void Gateway::waitForWork() noexcept {
  // A negative descriptor is one that poll() leaves out.
  std::array<pollfd, 2> sources{
      {{rc10d_.descriptor(), POLLIN, 0}, {lcm_ ? lcm_->descriptor() : -1, POLLIN, 0}}};
  (void)::poll(sources.data(), sources.size(), kMaxSleepMs);  // a signal ends it early
}

void Gateway::publish(std::string_view channel, std::span<const std::byte> message) noexcept {
  // A state that cannot leave now is worth nothing later.
  if (lcm_) (void)lcm_->publish(channel, message);
}

bool Gateway::receiveLcm(const ClockSample& now) {
  if (!lcm_) return true;
  for (int i = 0; i < kMaxDatagrams; ++i) {
    const auto incoming = lcm_->receive(datagram_);
    if (!incoming) {
      empty_ = now;
      return true;
    }
    // Read anew: this process may have been stopped since `now`, and what came meanwhile would pass as fresh.
    const ClockSample read = sampleClocks();
    const WakeUp wake = wakeUp(read, empty_);
    // Without a stamp nothing is known of its age but that it came after the socket was last empty.
    const auto received = incoming->stamp ? toMonotonic(*incoming->stamp, wake) : wake.previous;
    // On the loopback there is nothing from elsewhere.
    const bool here = loopback_ || origins_.isOwn(incoming->sender, read.now);
    const auto origin = here ? link::Origin::kThisComputer : link::Origin::kElsewhere;
    if (!inlet_.handle(incoming->datagram, received, read.now, origin)) return false;
  }
  return true;
}

bool Gateway::receiveLink() {
  for (int i = 0; i < kMaxLinkMessages; ++i) {
    const auto received = rc10d_.receive(link_buffer_);
    if (received.status == LinkClient::ReceiveStatus::kClosed) return false;
    if (received.status == LinkClient::ReceiveStatus::kNothing) return true;
    outlet_.forward(received.datagram);
  }
  return true;
}

void Gateway::watchTransport(const ClockSample& now) {
  if (now.now < next_check_) return;
  const auto opened = openTransport(now);
  if (opened) {
    pause_ = kFirstPause;
    next_check_ = now.now + kRouteCheck;
    return;
  }
  lcm_.reset();
  logOnce(opened.error().message);
  next_check_ = now.now + pause_;
  pause_ = std::clamp(2 * pause_, kFirstPause, kLongestPause);
}

Result<void> Gateway::openTransport(const ClockSample& now) {
  const auto route = findRoute(url_);
  if (!route) return tl::unexpected(route.error());
  if (auto fit = checkRoute(url_, *route); !fit) return fit;
  if (lcm_ && route->interface_index == interface_index_) return {};
  auto socket = UdpmSocket::open(url_, *route, inlet_.channels());
  if (!socket) return tl::unexpected(socket.error());
  lcm_ = std::move(*socket);
  interface_index_ = route->interface_index;
  loopback_ = route->loopback;
  empty_ = now;
  logOnce("LCM on " + url_.groupText() + ":" + std::to_string(url_.port) + " by interface " +
          route->interface + ", ttl " + std::to_string(url_.ttl));
  return {};
}

void Gateway::logOnce(const std::string& text) {
  if (text == last_log_) return;
  last_log_ = text;
  (void)lines_.tell("rc10-lcm: " + printable(text));
}

}  // namespace rc10::gateway
