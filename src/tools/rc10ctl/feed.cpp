#include "feed.hpp"

#include <algorithm>
#include <chrono>

#include "session.hpp"

namespace rc10::ctl {
namespace {

// Diagnostics come twice a second.
constexpr auto kDiagnosticsPatience = std::chrono::seconds{3};

}  // namespace

Feed::Feed(LinkClient& rc10d) : rc10d_(rc10d), buffer_(link::kMaxMessageSize) {
  const auto& welcome = rc10d.welcome();
  for (std::size_t i = 0; i < std::min<std::size_t>(welcome.module_count, link::kMaxModules); ++i)
    modules_.push_back({welcome.modules[i], link::ModuleInfo{}, link::ModuleState{}});
}

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
  } else if (link::ModuleInfo info; link::open(datagram, info)) {
    if (info.module < modules_.size()) modules_[info.module].info = info;
  } else if (link::ModuleState state; link::open(datagram, state)) {
    if (state.module < modules_.size()) modules_[state.module].state = state;
  } else if (link::Event event; link::open(datagram, event)) {
    events_.push_back(event);
  }
}

template <typename There>
Result<void> Feed::await(const There& there) {
  const auto deadline = std::chrono::steady_clock::now() + kDiagnosticsPatience;
  while (!there()) {
    if (!pump()) return tl::unexpected(rc10dEnded());
    if (there()) break;
    if (interrupted()) return fail("interrupted");
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left <= Duration{0}) return fail("rc10d sends nothing: is it stopped? See `systemctl status rc10d`");
    waitReadable(rc10d_, left);
  }
  return {};
}

Result<void> Feed::awaitState() {
  return await([this] { return state_.has_value(); });
}

Result<void> Feed::awaitDiagnostics() {
  return await([this] { return diagnostics_.has_value(); });
}

Result<void> Feed::awaitModules() {
  return await([this] {
    return std::all_of(modules_.begin(), modules_.end(),
                       [](const auto& module) { return module.state.mono_us != 0; });
  });
}

}  // namespace rc10::ctl
