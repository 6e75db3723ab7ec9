#include "web/page_messages.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "bus/frame_text.hpp"
#include "client/json_line.hpp"
#include "client/module_text.hpp"
#include "client/sighting_json.hpp"
#include "client/state_json.hpp"
#include "link/event_text.hpp"
#include "rc10_version.hpp"
#include "survey/frame_words.hpp"
#include "web/frame_writer.hpp"

namespace rc10::web {
namespace {

using client::Json;
using client::lineOf;

Json namesOf(std::span<const link::Name> names) {
  Json list = Json::array();
  for (const auto& name : names) list.push_back(name.view());
  return list;
}

// JSON of the client's writers in an envelope.
std::string wrapped(std::string_view type, const std::string& data) {
  return R"({"type":")" + std::string{type} + R"(","data":)" + data + "}";
}

}  // namespace

std::string helloMessage(PageRight right, std::string_view session_name) {
  constexpr std::array kWords{"nothing", "look", "command"};
  return lineOf({{"type", "hello"},
                 {"protocol", kPageProtocol},
                 {"version", kVersion},
                 {"right", kWords[static_cast<std::size_t>(right)]},
                 {"name", session_name}});
}

std::string downMessage(std::string_view reason, const DaemonEnd& end) {
  return lineOf({{"type", "down"},
                 {"reason", reason},
                 {"refusal", end.refusal},
                 {"refused_at", end.refused_at},
                 {"log", end.log},
                 {"logged_at", end.logged_at}});
}

std::string robotMessage(const RobotFeed& feed) {
  Json modules = Json::array();
  for (const auto& module : feed.modules()) {
    const auto names = std::span{module.info.names};
    const auto inputs = std::min<std::size_t>(module.info.input_count, link::kMaxSignals);
    const auto outputs = std::min<std::size_t>(module.info.output_count, link::kMaxSignals);
    modules.push_back({{"name", module.name.view()},
                       {"type", module.info.type.view()},
                       {"inputs", namesOf(names.first(inputs))},
                       {"outputs", namesOf(names.subspan(inputs, outputs))}});
  }
  Json readings = Json::array();
  for (const auto reading : link::kTraceReadings) readings.push_back(reading);
  return R"({"type":"robot","robot":)" + client::listJson(feed.welcome()) + R"(,"modules":)" +
         lineOf(modules) + R"(,"readings":)" + lineOf(readings) + "}";
}

std::string stateMessage(const RobotFeed& feed, const link::State& state) {
  return R"({"type":"state","data":)" + client::stateJson(feed.welcome(), state) + R"(,"modules":)" +
         client::modulesJson(feed.modules()) + "}";
}

std::string diagnosticsMessage(const RobotFeed& feed, const link::Diagnostics& diagnostics) {
  return wrapped("diagnostics", client::diagnosticsJson(feed.welcome(), diagnostics));
}

std::string eventMessage(const link::Event& event) {
  return lineOf({{"type", "event"},
                 {"utime", event.utime},
                 {"mono_us", event.mono_us},
                 {"severity", toString(event.severity)},
                 {"code", event.code},
                 {"source", event.source.view()},
                 {"client", event.client.view()},
                 {"text", event.text.view()}});
}

std::string viewMessage(std::uint32_t view, const std::vector<std::string>& drawn,
                        const std::vector<std::string>& unknown, std::int64_t dropped_ticks) {
  return lineOf({{"type", "view"},
                 {"view", view},
                 {"signals", drawn},
                 {"unknown", unknown},
                 {"dropped_ticks", dropped_ticks}});
}

std::string recordingsMessage(std::int64_t seq, const std::vector<RecordingFile>& files) {
  Json list = Json::array();
  for (const auto& file : files)
    list.push_back({{"name", file.name}, {"changed_us", file.changed_us}, {"live", file.live}});
  return lineOf({{"type", "recordings"}, {"seq", seq}, {"recordings", std::move(list)}});
}

std::string wordsMessage(const AskWords& asked) {
  Json events = Json::array();
  for (const auto& event : asked.events)
    events.push_back(link::eventText(event.code, event.value, event.extra, event.client));
  Json frames = Json::array();
  for (const auto& [bus, sent, text] : asked.frames) {
    const auto frame = parseFrameText(text);
    frames.push_back(frame ? survey::frameWords(*frame, asked.buses[bus], sent) : std::string{});
  }
  return lineOf(
      {{"type", "words"}, {"seq", asked.seq}, {"events", std::move(events)}, {"frames", std::move(frames)}});
}

std::string configHead(std::int64_t seq, std::string_view of, std::string_view sha256) {
  return R"({"type":"config","seq":)" + std::to_string(seq) + R"(,"of":")" + std::string{of} +
         R"(","sha256":")" + std::string{sha256} + R"(","config":)";
}

std::string checkedConfigHead(std::int64_t seq) {
  return R"({"type":"config_checked","seq":)" + std::to_string(seq) + R"(,"checked":)";
}

std::string clockMessage() { return lineOf({{"type", "clock"}}); }

std::string responseMessage(std::int64_t seq, std::string_view status, std::string_view message,
                            std::span<const link::NamedValue> values, std::span<const link::Sighting> heard) {
  Json told = Json::object();
  for (const auto& value : values) told[std::string{value.name.view()}] = value.value;
  Json sightings = Json::array();
  for (const auto& sighting : heard) sightings.push_back(client::sightingJson(sighting));
  return lineOf({{"type", "response"},
                 {"seq", seq},
                 {"status", status},
                 {"message", message},
                 {"values", std::move(told)},
                 {"heard", std::move(sightings)}});
}

std::string testMessage(std::int64_t seq, double time_s, double lasts_s) {
  return lineOf({{"type", "test"}, {"seq", seq}, {"time_s", time_s}, {"lasts_s", lasts_s}});
}

std::string testDoneMessage(std::int64_t seq, const client::MotionReport& report,
                            const client::MotionRun& run, std::string_view doing) {
  return lineOf({{"type", "test_done"},
                 {"seq", seq},
                 {"time_s", run.curve().empty() ? 0.0 : run.curve().back().time_s},
                 {"doing", doing},
                 {"report", client::jsonOf(report, run)}});
}

std::vector<std::byte> curveFrame(const client::Curve& curve, std::int64_t seq, std::size_t first) {
  using client::CurveSample;
  constexpr std::array kColumns{&CurveSample::time_s,          &CurveSample::target,
                                &CurveSample::target_shaped,   &CurveSample::measured,
                                &CurveSample::total_angle_deg, &CurveSample::velocity_rpm,
                                &CurveSample::current_a,       &CurveSample::feedback_age_us};
  const std::size_t begin = std::min(first, curve.size());
  const auto ticks = std::span{curve}.subspan(begin, std::min(kMaxCurveTicks, curve.size() - begin));
  FrameWriter out{kFrameHeaderBytes + (kColumns.size() + 1) * ticks.size() * sizeof(double)};
  out.add(kFrameVersion);
  out.add(FrameKind::kCurve);
  out.add(static_cast<std::uint16_t>(kColumns.size() + 1));
  out.add(static_cast<std::uint32_t>(ticks.size()));
  out.add(std::uint64_t{0});
  out.add(static_cast<double>(seq));
  out.add(static_cast<double>(begin));
  for (const auto column : kColumns) {
    for (const auto& tick : ticks) out.add(tick.*column);
  }
  for (const auto& tick : ticks) out.add(static_cast<double>(tick.limits));
  return out.take();
}

}  // namespace rc10::web
