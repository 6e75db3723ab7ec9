#include "client/recording_text.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <deque>

#include "app/event_code.hpp"
#include "app/printable.hpp"
#include "app/text_table.hpp"
#include "client/quantity_text.hpp"
#include "link/event_text.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

using namespace blackbox;

constexpr std::size_t kEventsShown = 10;

/// "2026-11-21 16:05:29.123456", UTC.
[[nodiscard]] std::string utc(std::int64_t wall_us) {
  if (wall_us < 0) return "?";
  const auto seconds = static_cast<std::time_t>(wall_us / 1'000'000);
  std::tm parts{};
  (void)::gmtime_r(&seconds, &parts);
  std::array<char, 40> text{};
  const auto size = std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &parts);
  std::array<char, 16> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%06d", static_cast<int>(wall_us % 1'000'000));
  return std::string(text.data(), size) + fraction.data();
}

[[nodiscard]] std::string ending(const Recording& recording, bool running) {
  const auto cause = printable(recording.header().cause.view());
  if (cause == "crash") return "rc10d ended without stopping: it crashed or was killed";
  if (!cause.empty()) return "a copy, made because of: " + cause;
  if (recording.control().ended != 0) return "rc10d stopped in good order";
  if (running) return "rc10d is still recording";
  return "rc10d ended without stopping: it crashed or was killed";
}

// A program that goes on sending has each of its setpoints skipped.
[[nodiscard]] bool isSame(const Event& one, const Event& other) noexcept {
  return one.header.id == other.header.id && one.header.source == other.header.source &&
         one.value == other.value && one.extra == other.extra && one.client.view() == other.client.view();
}

struct Counts {
  std::size_t received = 0;
  std::size_t sent = 0;
  std::size_t refused = 0;
  std::size_t commands = 0;
  std::size_t commands_refused = 0;
  std::size_t signals = 0;
  std::size_t signals_refused = 0;
  std::size_t requests = 0;
  std::size_t events = 0;
  std::size_t states = 0;
  std::int64_t ticks_missed = 0;
  struct Told {
    Event event;  ///< The last of them.
    std::size_t times = 1;
  };
  std::deque<Told> last_events;

  void add(const Frame& frame) {
    const bool is_sent = (frame.header.flags & kFrameSent) != 0;
    ++(!is_sent ? received : (frame.header.flags & kFrameRefused) != 0 ? refused : sent);
  }
  void add(const Command& command) {
    ++(command.header.flags == static_cast<std::uint8_t>(Verdict::kApplied) ? commands : commands_refused);
  }
  void add(const Setpoint&) noexcept {}
  void add(const Order&) noexcept { ++requests; }
  void add(const Event& event) {
    ++events;
    // Hundreds, of a busy computer, would crowd out what happened to the robot.
    if (EventCode{static_cast<std::int32_t>(event.header.id)} == EventCode::kTicksMissed) {
      ticks_missed += event.value;
      return;
    }
    Told told{event};
    const auto same = std::find_if(last_events.begin(), last_events.end(),
                                   [&](const Told& other) { return isSame(other.event, event); });
    if (same != last_events.end()) {
      told.times += same->times;
      last_events.erase(same);
    }
    last_events.push_back(told);
    if (last_events.size() > kEventsShown) last_events.pop_front();
  }
  void add(const Motor&) noexcept { ++states; }
  void add(const Robot&) noexcept {}
  void add(const Signals& record) {
    ++(record.header.flags == static_cast<std::uint8_t>(Verdict::kApplied) ? signals : signals_refused);
  }
  void add(const Bus&) noexcept {}
};

[[nodiscard]] std::string countTable(const Recording& recording, const Counts& counts) {
  TextTable table({{"RECORDED"}, {"", TextTable::Align::kRight}});
  const auto row = [&table](const char* what, std::uint64_t count) {
    table.add({what, std::to_string(count)});
  };
  row("frames received", counts.received);
  row("frames sent", counts.sent);
  row("frames not accepted by the kernel", counts.refused);
  row("commands", counts.commands);
  row("commands refused", counts.commands_refused);
  if (recording.header().module_count > 0) {
    row("inputs of modules", counts.signals);
    row("inputs of modules refused", counts.signals_refused);
  }
  row("requests", counts.requests);
  row("events", counts.events);
  row("ticks missed", static_cast<std::uint64_t>(counts.ticks_missed));
  row("states of motors", counts.states);
  row("lost: recorded faster than written", recording.control().dropped);
  return table.text();
}

[[nodiscard]] std::string eventTable(const Recording& recording, const Counts& counts) {
  if (counts.last_events.empty()) return {};
  TextTable table({{"LAST EVENTS (UTC)"}, {""}, {""}, {""}});
  for (const auto& [event, times] : counts.last_events) {
    const std::string often = times > 1 ? " (" + std::to_string(times) + " times)" : "";
    table.add({utc(recording.wallUs(event.header.time_ns)), toString(Severity{event.header.flags}),
               printable(recording.sourceName(event)), printable(eventText(recording, event)) + often});
  }
  return table.text();
}

}  // namespace

std::string eventText(const Recording& recording, const Event& event) {
  const auto own = EventCode{static_cast<std::int32_t>(event.header.id)} == EventCode::kModule
                       ? recording.moduleEvent(event.header.source, event.value)
                       : std::string_view{};
  if (!own.empty()) return std::string(own);
  return link::eventText(static_cast<std::int32_t>(event.header.id), event.value, event.extra,
                         event.client.view());
}

std::string recordingText(const Recording& recording, bool running) {
  Counts counts;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    std::visit([&counts](const auto& record) { counts.add(record); }, recording.at(i));
  }
  const auto& header = recording.header();
  std::string text = "robot " + printable(header.robot.view()) + "  rc10d " +
                     printable(header.program_version.view()) + ", pid " + std::to_string(header.pid) + ", " +
                     std::to_string(header.rate_hz) + " Hz\n" + ending(recording, running) + "\n";
  if (recording.size() == 0) return text + "nothing is recorded\n";
  const double span_s =
      (static_cast<double>(recording.lastNs()) - static_cast<double>(recording.firstNs())) * 1e-9;
  text += utc(recording.wallUs(recording.firstNs())) + " to " + utc(recording.wallUs(recording.lastNs())) +
          " UTC: " + quantity(span_s, 1, "s") + "\n";
  if (recording.damagedBytes() > 0) {
    text += "damaged: " + std::to_string(recording.damagedBytes()) + " bytes after the last record\n";
  }
  return text + countTable(recording, counts) + eventTable(recording, counts);
}

}  // namespace rc10::client
