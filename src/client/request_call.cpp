#include "client/request_call.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <string>

#include "client/daemon_log.hpp"

namespace rc10 {

std::uint64_t randomSession() {
  std::random_device device;
  return (std::uint64_t{device()} << 32U) | device();
}

RequestCall::RequestCall(LinkClient& connection, std::string_view client_name)
    : connection_(connection),
      client_(client_name),
      session_(randomSession()),
      buffer_(link::kMaxMessageSize) {}

Result<link::Response> RequestCall::call(link::Request request, Duration timeout, const Other& other,
                                         bool (*given_up)() noexcept) {
  using std::chrono::steady_clock;
  const auto deadline = steady_clock::now() + timeout;
  request.client = client_;
  request.session = session_;
  request.seq = ++seq_;
  const auto sent = connection_.send(request);
  if (sent == LinkClient::SendStatus::kBusy) {
    return fail("rc10d does not take requests: it is overloaded or stopped; see `systemctl status rc10d`");
  }
  for (;;) {
    const auto received = connection_.receive(buffer_);
    if (received.status == LinkClient::ReceiveStatus::kClosed || sent == LinkClient::SendStatus::kClosed) {
      return fail(std::string("rc10d ended before it answered: ") + client::kSeeItsLog);
    }
    link::Response response;
    if (received.status == LinkClient::ReceiveStatus::kMessage) {
      if (answers(received.datagram, response)) return response;
      if (other) other(received.datagram);
      if (steady_clock::now() < deadline) continue;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
    if (left <= 0) {
      const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(timeout).count();
      return fail("rc10d did not answer within " + std::to_string(waited) + " ms: " + client::kSeeItsLog);
    }
    if (given_up != nullptr && given_up()) return fail("interrupted: rc10d has not answered yet");
    pollfd entry{.fd = connection_.descriptor(), .events = POLLIN, .revents = 0};
    (void)::poll(&entry, 1, static_cast<int>(std::min<std::int64_t>(left, 60'000)));  // a signal: looks again
  }
}

bool RequestCall::answers(std::span<const std::byte> datagram, link::Response& response) const noexcept {
  return link::open(datagram, response) && response.session == session_ && response.seq == seq_ &&
         response.client.view() == client_.view();
}

}  // namespace rc10
