#include "daemon/threads/line_loop.hpp"

#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/timespec.hpp"
#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

[[nodiscard]] constexpr bool bit(std::uint32_t levels, std::size_t place) noexcept {
  return ((levels >> place) & 1U) != 0;
}

}  // namespace

LineLoop::LineLoop(LineBanks& banks, std::unique_ptr<GpioSystem> gpio, LinkExchange& exchange)
    : banks_(banks),
      gpio_(std::move(gpio)),
      notes_(exchange.line_notes, EventCode::kDevice),
      lines_(banks.size()),
      interval_(kIdleInterval) {
  for (std::size_t i = 0; i < banks_.size(); ++i) {
    if (!banks_[i].settings().inputs.empty()) interval_ = kLookInterval;
  }
}

void LineLoop::run(const std::stop_token& stop, const Scheduler& scheduler) {
  while (!stop.stop_requested()) {
    turn(monotonicNow(), scheduler.ticks());
    const timespec patience = toTimespec(interval());
    pollfd wake{.fd = banks_.wake(), .events = POLLIN, .revents = 0};
    if (::ppoll(&wake, 1, &patience, nullptr) > 0) {
      eventfd_t changes = 0;
      (void)::eventfd_read(wake.fd, &changes);
    }
  }
  end();
}

// Failures are retried soon, also where outputs alone are used.
Duration LineLoop::interval() const noexcept {
  const bool failing =
      std::any_of(lines_.begin(), lines_.end(), [](const Bank& b) { return b.bad_turns != 0; });
  return failing ? kLookInterval : interval_;
}

void LineLoop::turn(MonotonicTime now, std::uint64_t ticks) {
  watchScheduler(now, ticks);
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (!lines_[i].held && lines_[i].pace.due(now)) tryToOpen(i, now);
    if (lines_[i].held) work(i, now);
  }
}

void LineLoop::work(std::size_t index, MonotonicTime now) {
  auto& lines = lines_[index];
  auto& bank = banks_[index];
  const auto wanted = silence_ > kMaxSilence ? bank.settings().safe_levels : bank.wanted();
  // Now and then all, for a chip whose outputs alone are used: its loss is noticed too.
  const bool all = now - lines.refreshed >= kIdleInterval;
  if (all) lines.refreshed = now;
  drive(lines, wanted, all);
  const auto levels = read(lines);
  if (!levels || lines.unwritten != 0) {
    badTurn(index, !levels, now);
    if (!lines.answers) return;
  } else {
    goodTurn(index, now);
  }
  if (levels) {
    bank.show(*levels, lines.unwritten);
  } else {
    bank.showUnread(lines.unwritten);
  }
}

void LineLoop::goodTurn(std::size_t index, MonotonicTime now) {
  auto& lines = lines_[index];
  lines.bad_turns = 0;
  if (std::exchange(lines.answers, true)) return;
  const auto& settings = banks_[index].settings();
  lines.pace.opened(now);
  notes_.tell(settings.name, Severity::kInfo,
              fmt::format("{}: {} inputs and {} outputs are open", settings.chip, settings.inputs.size(),
                          settings.outputs.size()),
              now);
}

void LineLoop::badTurn(std::size_t index, bool unread, MonotonicTime now) {
  auto& lines = lines_[index];
  const auto& settings = banks_[index].settings();
  if (!lines.answers || ++lines.bad_turns >= kMaxBadTurns) return lose(index, now);
  ++lines.failures;
  if (lines.failures_told && now - *lines.failures_told < kTellBadTurns) return;
  lines.failures_told = now;
  std::string what = unread ? "an input was not read" : "";
  for (std::size_t i = 0; i < settings.outputs.size(); ++i) {
    if (!bit(lines.unwritten, i)) continue;
    what +=
        fmt::format("{}output {} did not take its level", what.empty() ? "" : ", ", settings.outputs[i].name);
  }
  notes_.tell(settings.name, Severity::kWarning,
              fmt::format("{}: a transfer failed and is tried again ({} since the last report): {}",
                          settings.chip, std::exchange(lines.failures, 0), what),
              now);
}

void LineLoop::watchScheduler(MonotonicTime now, std::uint64_t ticks) {
  const auto since = last_turn_ ? std::min(now - *last_turn_, kIdleInterval) : Duration::zero();
  last_turn_ = now;
  const bool was_silent = silence_ > kMaxSilence;
  silence_ = ticks == std::exchange(last_ticks_, ticks) ? silence_ + since : Duration::zero();
  if (ticks == 0 || was_silent || silence_ <= kMaxSilence) return;
  for (std::size_t i = 0; i < banks_.size(); ++i) {
    if (banks_[i].settings().outputs.empty()) continue;
    notes_.tell(banks_[i].settings().name, Severity::kError,
                "no tick for 0.2 s: the outputs go to their safe values", now);
  }
}

void LineLoop::tryToOpen(std::size_t index, MonotonicTime now) {
  auto& lines = lines_[index];
  lines.pace.begin(now);
  if (const auto opened = open(banks_[index], lines); !opened) {
    if (lines.pace.failed(opened.error().message))
      notes_.tell(banks_[index].settings().name, Severity::kWarning, opened.error().message, now);
    return;
  }
  lines.held = true;
}

// All or none: half of a module's lines would be worse than none.
Result<void> LineLoop::open(LineBank& bank, Bank& lines) {
  const auto& settings = bank.settings();
  const auto failed = [&lines](const Error& error) {
    lines.inputs.clear();
    lines.outputs.clear();
    return tl::unexpected(error);
  };
  // Inputs first: when one is refused no output has been touched.
  for (const auto& input : settings.inputs) {
    auto opened = gpio_->openInput(input.name, {settings.chip, input.line}, input.bias);
    if (!opened) return failed(opened.error());
    lines.inputs.push_back(std::move(*opened));
  }
  for (std::size_t i = 0; i < settings.outputs.size(); ++i) {
    const auto& output = settings.outputs[i];
    auto opened = gpio_->openOutput(output.name, {settings.chip, output.line}, bit(settings.safe_levels, i));
    if (!opened) return failed(opened.error());
    lines.outputs.push_back(std::move(*opened));
  }
  lines.driven = settings.safe_levels;
  lines.unwritten = 0;
  return {};
}

void LineLoop::drive(Bank& lines, std::uint32_t levels, bool all) noexcept {
  for (std::size_t i = 0; i < lines.outputs.size(); ++i) {
    if (!all && !bit(lines.unwritten, i) && bit(levels, i) == bit(lines.driven, i)) continue;
    // One that refuses must not keep the others from their safe values.
    const std::uint32_t mask = 1U << i;
    if (lines.outputs[i]->set(bit(levels, i))) {
      lines.driven = (lines.driven & ~mask) | (levels & mask);
      lines.unwritten &= ~mask;
    } else {
      lines.unwritten |= mask;
    }
  }
}

std::optional<std::uint32_t> LineLoop::read(Bank& lines) noexcept {
  std::uint32_t levels = 0;
  for (std::size_t i = 0; i < lines.inputs.size(); ++i) {
    const auto high = lines.inputs[i]->high();
    if (!high) return std::nullopt;
    levels |= (*high ? 1U : 0U) << i;
  }
  return levels;
}

void LineLoop::lose(std::size_t index, MonotonicTime now) {
  auto& lines = lines_[index];
  const auto& settings = banks_[index].settings();
  drive(lines, settings.safe_levels, true);  // those that still obey
  lines.inputs.clear();
  lines.outputs.clear();
  lines.held = false;
  lines.bad_turns = 0;
  banks_[index].showClosed();
  if (!std::exchange(lines.answers, false)) {
    // It can be opened and does not answer, again and again: told once.
    const auto text = fmt::format("{}: the chip does not answer", settings.chip);
    if (lines.pace.failed(text)) notes_.tell(settings.name, Severity::kWarning, text, now);
    return;
  }
  lines.pace.lost(now);
  notes_.tell(
      settings.name, Severity::kWarning,
      fmt::format(
          "{}: the chip is gone or does not answer: its inputs mean nothing, its outputs may be anything",
          settings.chip),
      now);
}

void LineLoop::end() noexcept {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].held) drive(lines_[i], banks_[i].settings().safe_levels, true);
    lines_[i] = {};
    banks_[i].showClosed();
  }
}

}  // namespace rc10
