#include "daemon/interfaces/can_link_keeper.hpp"

#include <utility>

#include <fmt/format.h>

namespace rc10 {
namespace {

// 50 ms doubled six times is above 2 s.
constexpr int kAttemptsTold = 7;

[[nodiscard]] const char* reason(BusState state) noexcept {
  switch (state) {
    case BusState::kBusOff: return "bus-off";
    case BusState::kStalled: return "stalled";
    case BusState::kDown: return "interface down";
    default: return "in trouble";
  }
}

[[nodiscard]] const char* lookAt(BusState state) noexcept {
  return state == BusState::kStalled ? "check that another node is powered and connected, and the bit rates"
                                     : "check wiring, termination and bit rates";
}

[[nodiscard]] std::string restarted(const std::string& interface, const CanLinkSettings& wanted) {
  return fmt::format("{} taken down and up at {}", interface, bitrates(wanted));
}

}  // namespace

std::string settingsAdvice(const std::string& interface, const CanLink& link, const CanLinkSettings& wanted) {
  const auto wrong = wrongSetting(interface, link, wanted);
  return wrong.empty() ? wrong : wrong + "; type: " + restartCommand(interface, link, wanted);
}

void CanLinkKeeper::check(MonotonicTime now, std::bitset<kMaxBuses> came_up) {
  for (std::size_t i = 0; i < robot_.buses().size(); ++i) {
    const auto& entry = robot_.buses()[i];
    if (entry.interface.empty()) continue;
    // The link is shown as down until the reviver's next look: that is no trouble.
    if (came_up[i] && mendSettings(i, now)) continue;
    const auto state = inboxes_[i].state.load(std::memory_order_relaxed);
    const auto step = kept_[i].recovery.update(now, state);
    if (!step.due) continue;
    if (entry.manage_link) {
      recover(i, state, now);
      continue;
    }
    const auto seen = driver_.read(entry.interface);
    if (!seen) continue;  // it has just vanished
    if (state == BusState::kBusOff && seen->bus_off == false) {
      // The message about the restart was lost: nothing else would tell the scheduler.
      inboxes_[i].controller_running.fetch_add(1, std::memory_order_relaxed);
    } else if (step.first) {
      advise(i, state, *seen, now);
    }
  }
}

// Somebody has brought the interface up, or it is a new one: are its settings ours?
bool CanLinkKeeper::mendSettings(std::size_t bus, MonotonicTime now) {
  const auto& entry = robot_.buses()[bus];
  if (std::exchange(kept_[bus].by_us, false)) return false;
  const auto link = driver_.read(entry.interface);
  if (!link) return false;
  const auto wrong = wrongSetting(entry.interface, *link, entry.settings);
  if (wrong.empty()) return false;
  if (!entry.manage_link) {
    notes_.tell(nameOf(bus), Severity::kWarning, settingsAdvice(entry.interface, *link, entry.settings), now);
    return false;
  }
  if (!restart(bus, now)) return false;
  kept_[bus].recovery.tried(now);
  notes_.tell(nameOf(bus), Severity::kWarning,
              fmt::format("{}: {}", wrong, restarted(entry.interface, entry.settings)), now);
  return true;
}

void CanLinkKeeper::recover(std::size_t bus, BusState why, MonotonicTime now) {
  const auto& entry = robot_.buses()[bus];
  if (!restart(bus, now)) return;
  const int attempts = kept_[bus].recovery.attempts();
  if (attempts > kAttemptsTold) return;
  auto text = fmt::format("{}: {}", reason(why), restarted(entry.interface, entry.settings));
  if (attempts == kAttemptsTold) {
    text += fmt::format("; from now on every 2 s, without telling it again. {}", lookAt(why));
  }
  notes_.tell(nameOf(bus), Severity::kWarning, text, now);
}

bool CanLinkKeeper::restart(std::size_t bus, MonotonicTime now) {
  const auto& entry = robot_.buses()[bus];
  auto& kept = kept_[bus];
  // Shown as down until the reviver finds it up: the scheduler must see that the link was away.
  inboxes_[bus].link.store(CanLinkState::kDown, std::memory_order_relaxed);
  const auto done = driver_.restart(entry.interface, entry.settings);
  const auto error = done ? std::string{} : done.error().message;
  if (!error.empty() && error != kept.last_error) notes_.tell(nameOf(bus), Severity::kError, error, now);
  kept.last_error = error;
  kept.by_us = error.empty();
  return kept.by_us;
}

void CanLinkKeeper::advise(std::size_t bus, BusState why, const CanLink& link, MonotonicTime now) {
  const auto& entry = robot_.buses()[bus];
  const auto advice = why == BusState::kDown
                          ? fmt::format("{} is down; type: {}", entry.interface,
                                        upCommand(entry.interface, link, entry.settings))
                          : fmt::format("{}: {}, then type: {}", reason(why), lookAt(why),
                                        restartCommand(entry.interface, link, entry.settings));
  notes_.tell(nameOf(bus), Severity::kWarning,
              advice + (link.isController() ? " (rc10d does it itself with `manage_link: true`)" : ""), now);
}

std::string_view CanLinkKeeper::nameOf(std::size_t bus) const { return robot_.buses()[bus].bus->name(); }

}  // namespace rc10
