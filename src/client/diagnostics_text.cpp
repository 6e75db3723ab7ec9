#include <algorithm>
#include <span>
#include <vector>

#include "app/printable.hpp"
#include "app/text_table.hpp"
#include "client/quantity_text.hpp"
#include "client/state_text.hpp"
#include "link/late_causes.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

using Align = TextTable::Align;

std::string micros(float value) { return quantity(static_cast<double>(value), 1, "us"); }

std::string timesText(const link::Diagnostics& diagnostics) {
  TextTable table({{"TIME"},
                   {"P50", Align::kRight},
                   {"P99", Align::kRight},
                   {"P99.9", Align::kRight},
                   {"MAX", Align::kRight}});
  const auto row = [&table](const std::string& name, const link::Percentiles& p) {
    table.add({name, micros(p.p50_us), micros(p.p99_us), micros(p.p999_us), micros(p.max_us)});
  };
  row("wake-up latency", diagnostics.wake_latency);
  row("tick duration", diagnostics.tick_duration);
  for (std::size_t i = 0; i < std::min<std::size_t>(diagnostics.duration_count, link::kMaxDurations); ++i) {
    const auto& each = diagnostics.durations[i];
    if (each.count > 0) row(printable(each.name.view()), each.percentiles);
  }
  return table.text();
}

// Null: a counter of something else.
const LateCauseWords* wordsOfLateTicks(std::string_view counter) {
  if (counter.starts_with(kTakenByWords.counter)) return &kTakenByWords;
  const auto* const found = std::find_if(kLateCauseWords.begin(), kLateCauseWords.end(),
                                         [counter](const auto& cause) { return cause.counter == counter; });
  return found == kLateCauseWords.end() ? nullptr : found;
}

// A line for each cause that there was, with what helps against it.
std::string lateTicksText(const link::Diagnostics& diagnostics) {
  std::string text;
  const auto counters = std::span{diagnostics.counters}.first(
      std::min<std::size_t>(diagnostics.counter_count, link::kMaxCounters));
  for (const auto& counter : counters) {
    const auto name = counter.name.view();
    const auto* words = wordsOfLateTicks(name);
    if (words == nullptr || counter.count == 0) continue;
    text += printable(name) + " " + std::to_string(counter.count) + " (" + std::string(words->advice) + ")\n";
  }
  return text;
}

std::string counterOrUnknown(std::int16_t value) { return value < 0 ? "-" : std::to_string(value); }

// A column for each bus: there are few buses and many numbers.
std::string busesText(std::span<const link::BusStatus> buses) {
  std::vector<TextTable::Column> columns{{"BUS"}};
  for (const auto& bus : buses) columns.push_back({printable(bus.name.view()), Align::kRight});
  TextTable table(std::move(columns));
  const auto row = [&](const char* name, auto&& cell) {
    std::vector<std::string> cells{name};
    for (const auto& bus : buses) cells.push_back(cell(bus));
    table.add(std::move(cells));
  };
  const auto load = [&](const char* name, float link::BusStatus::*ratio) {
    row(name, [ratio](const auto& bus) { return percent(static_cast<double>(bus.*ratio)); });
  };
  const auto count = [&](const char* name, std::int64_t link::BusStatus::*counter) {
    row(name, [counter](const auto& bus) { return std::to_string(bus.*counter); });
  };
  row("interface", [](const auto& bus) { return printable(bus.interface.view()); });
  row("state", [](const auto& bus) { return std::string(toString(bus.state)); });
  load("load", &link::BusStatus::measured_load);
  load("  predicted", &link::BusStatus::predicted_load);
  load("  predicted worst", &link::BusStatus::predicted_load_worst);
  count("frames received", &link::BusStatus::rx_frames);
  count("  of no motor", &link::BusStatus::rx_unmatched);
  count("  foreign sender", &link::BusStatus::rx_foreign);
  count("  malformed", &link::BusStatus::rx_malformed);
  count("  lost", &link::BusStatus::rx_dropped);
  count("frames sent", &link::BusStatus::tx_frames);
  count("  echoed", &link::BusStatus::tx_confirmed);
  count("  not taken", &link::BusStatus::tx_dropped);
  count("  held back", &link::BusStatus::tx_held);
  count("error frames", &link::BusStatus::error_frames);
  row("  TEC, REC",
      [](const auto& bus) { return counterOrUnknown(bus.tec) + ", " + counterOrUnknown(bus.rec); });
  count("restarts", &link::BusStatus::restarts);
  return table.text();
}

std::string refusalsText(const link::Diagnostics& diagnostics) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(diagnostics.refusal_count, link::kMaxRefusalReasons);
       ++i) {
    const auto& refusal = diagnostics.refusals[i];
    if (refusal.count == 0) continue;
    text += (text.empty() ? "" : ", ") + printable(refusal.name.view()) + " " + std::to_string(refusal.count);
  }
  return "refused commands: " + (text.empty() ? "none" : text) + '\n';
}

}  // namespace

std::string diagnosticsText(const link::Welcome& welcome, const link::Diagnostics& diagnostics) {
  std::string text = "robot " + printable(welcome.robot.view()) + "  tick " +
                     std::to_string(diagnostics.tick) + ", one every " +
                     std::to_string(diagnostics.tick_period_us) + " us\n";
  text += timesText(diagnostics);
  text += "missed ticks " + std::to_string(diagnostics.missed_ticks) + ", page faults " +
          std::to_string(diagnostics.page_faults) + ", events dropped " +
          std::to_string(diagnostics.events_dropped) + '\n';
  text += lateTicksText(diagnostics);
  const auto buses =
      std::span{diagnostics.buses}.first(std::min<std::size_t>(diagnostics.bus_count, link::kMaxBuses));
  if (!buses.empty()) text += busesText(buses);
  text += refusalsText(diagnostics);
  for (std::size_t i = 0; i < std::min<std::size_t>(diagnostics.notice_count, link::kMaxNotices); ++i) {
    text += "note: " + printable(diagnostics.notices[i].view()) + '\n';
  }
  return text;
}

}  // namespace rc10::client
