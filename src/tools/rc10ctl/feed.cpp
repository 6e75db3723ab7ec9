#include "feed.hpp"

#include <chrono>

#include "session.hpp"

namespace rc10::ctl {
namespace {

// Diagnostics come twice a second.
constexpr auto kDiagnosticsPatience = std::chrono::seconds{3};

}  // namespace

bool Feed::pump() {
  for (;;) {
    const auto received = rc10d_.receive(buffer_);
    if (received.status == LinkClient::ReceiveStatus::kClosed) return false;
    if (received.status == LinkClient::ReceiveStatus::kNothing) return true;
    take(received.datagram);
  }
}

void Feed::take(std::span<const std::byte> datagram) {
  link::Header header;
  if (!link::readHeader(datagram, header)) return;
  if (header.type == link::MessageType::kState) {
    if (!state_) state_.emplace();
    if (!link::open(datagram, *state_)) state_.reset();
    state_time_ = std::chrono::steady_clock::now();
  } else if (header.type == link::MessageType::kDiagnostics) {
    if (!diagnostics_) diagnostics_.emplace();
    if (!link::open(datagram, *diagnostics_)) diagnostics_.reset();
  } else if (link::Event event; link::open(datagram, event)) {
    events_.push_back(event);
  }
}

template <typename Message>
Result<void> Feed::await(const std::optional<Message>& message) {
  const auto deadline = std::chrono::steady_clock::now() + kDiagnosticsPatience;
  while (!message) {
    if (!pump()) return tl::unexpected(rc10dEnded());
    if (message) break;
    if (interrupted()) return fail("interrupted");
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left <= Duration{0}) return fail("rc10d sends nothing: is it stopped? See `systemctl status rc10d`");
    waitReadable(rc10d_, left);
  }
  return {};
}

Result<void> Feed::awaitState() { return await(state_); }
Result<void> Feed::awaitDiagnostics() { return await(diagnostics_); }

}  // namespace rc10::ctl
