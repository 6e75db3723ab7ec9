#include "daemon/threads/gpio_loop.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "daemon/devices/gpio_lines.hpp"
#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

// An edge wakes the thread at once. The level is read this often all the same: for a chip that vanished, and
// for edges that the kernel had no room for.
constexpr Duration kLookInterval = std::chrono::milliseconds{10};
// Between two looks, and the interval of the looks where the chip has no interrupts: a line that flutters, or
// a chip that only reports errors, must not keep a real-time thread busy.
constexpr Duration kPause = std::chrono::milliseconds{1};

}  // namespace

GpioLoop::GpioLoop(std::unique_ptr<ContactInput> contact, std::optional<Heartbeat> heartbeat,
                   LinkExchange& link, std::unique_ptr<ContactInput> enabling,
                   std::unique_ptr<ContactInput> mode)
    : contact_(std::move(contact)),
      enabling_(std::move(enabling)),
      mode_(std::move(mode)),
      heartbeat_(std::move(heartbeat)),
      link_(link) {}

Result<std::unique_ptr<GpioLoop>> GpioLoop::create(const RobotConfig& config, LinkExchange& link) {
  std::unique_ptr<ContactInput> contact;
  std::unique_ptr<ContactInput> enabling;
  std::unique_ptr<ContactInput> mode;
  std::optional<Heartbeat> heartbeat;
  const auto open = [](const std::optional<ContactGpioConfig>& wanted, const char* key,
                       std::unique_ptr<ContactInput>& input) -> Result<void> {
    if (!wanted) return {};
    auto opened = openContact(*wanted, key);
    if (!opened) return tl::unexpected(opened.error());
    input = std::move(*opened);
    return {};
  };
  if (auto done = open(config.estop_gpio, "estop_gpio", contact); !done) return tl::unexpected(done.error());
  if (auto done = open(config.enabling_gpio, "enabling_gpio", enabling); !done)
    return tl::unexpected(done.error());
  if (auto done = open(config.mode_gpio, "mode_gpio", mode); !done) return tl::unexpected(done.error());
  if (config.heartbeat_gpio) {
    auto opened = openPulse(*config.heartbeat_gpio);
    if (!opened) return tl::unexpected(opened.error());
    heartbeat.emplace(std::move(*opened), config.heartbeat_gpio->period);
  }
  if (!contact && !enabling && !mode && !heartbeat) return nullptr;
  auto loop = std::make_unique<GpioLoop>(std::move(contact), std::move(heartbeat), link, std::move(enabling),
                                         std::move(mode));
  loop->turn({}, 0);  // the first tick knows already
  return loop;
}

// The e-stop input is waited for; beside it the others are looked at more often. None loses an opening: the
// kernel keeps the edges.
ContactState GpioLoop::look(Duration patience) noexcept {
  const auto enabled = [this](Duration timeout) {
    const auto state = enabling_->wait(timeout);
    return state == ContactState::kOpen ? ContactState::kReleased : state;
  };
  if (!contact_) return enabled(patience);
  if (!enabling_) return contact_->wait(patience);
  const auto contact = contact_->wait(std::min(patience, kPause));
  const auto enabling = enabled(Duration::zero());
  return contact != ContactState::kClosed ? contact : enabling;
}

void GpioLoop::turn(MonotonicTime now, std::uint64_t ticks) noexcept {
  if (heartbeat_ && !heartbeat_->step(now, ticks)) heartbeat_failed_.store(true);
  const auto due = heartbeat_ ? std::max(heartbeat_->next() - now, Duration::zero()) : kLookInterval;
  const auto patience = std::min(due, kLookInterval);
  const bool stops = contact_ || enabling_;
  if (stops) link_.estop_contact.show(look(mode_ ? std::min(patience, kPause) : patience));
  if (mode_) link_.mode_contact.show(mode_->wait(stops ? Duration::zero() : patience));
  if (!stops && !mode_) std::this_thread::sleep_for(patience);
}

void GpioLoop::run(const std::stop_token& stop, const Scheduler& scheduler) noexcept {
  while (!stop.stop_requested()) {
    turn(monotonicNow(), scheduler.beats());
    std::this_thread::sleep_for(kPause);
  }
  if (heartbeat_) heartbeat_->end();
}

}  // namespace rc10
