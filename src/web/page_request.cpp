#include "web/page_request.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <nlohmann/json.hpp>

#include "app/printable.hpp"
#include "link/link_protocol.hpp"
#include "link/words.hpp"
#include "web/columns_frame.hpp"

namespace rc10::web {
namespace {

using Received = nlohmann::json;

// A column is at least a tick of the fastest loop wide, and at most a minute.
constexpr double kMinColumnUs = 100.0;
constexpr double kMaxColumnUs = 60e6;
constexpr double kMaxSpanUs = 3600e6;
// Whole numbers beyond it are not exact in a page.
constexpr double kMaxExact = 9007199254740991.0;
// Modes in which the motor stays where it is when it is let go; and a bound far beyond any motor.
constexpr std::array<std::string_view, 2> kHeldModes{toString(ControlMode::kVelocity),
                                                     toString(ControlMode::kCurrent)};
constexpr double kMostHeld = 1e6;

const Received* memberOf(const Received& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

std::string textOf(const Received& object, const char* key) {
  const auto* member = memberOf(object, key);
  return member != nullptr && member->is_string() ? member->get<std::string>() : std::string{};
}

Result<std::int64_t> wholeOf(const Received& object, const char* key, double least, double most) {
  const auto* member = memberOf(object, key);
  const double value = member != nullptr && member->is_number() ? member->get<double>() : std::nan("");
  if (!(value >= least && value <= most))
    return fail(std::string{"'"} + key + "' is missing or out of range");
  return static_cast<std::int64_t>(value);
}

/// Number of a message, and when it was sent, by the page's clock.
struct NumberAndTime {
  std::int64_t seq = 0;
  Duration sent{};
};
Result<NumberAndTime> numberAndTimeOf(const Received& object) {
  const auto seq = wholeOf(object, "seq", 0, kMaxExact);
  if (!seq) return tl::unexpected(seq.error());
  const auto sent_us = wholeOf(object, "sent_us", 0, kMaxExact);
  if (!sent_us) return tl::unexpected(sent_us.error());
  return NumberAndTime{*seq, std::chrono::microseconds{*sent_us}};
}

Result<PageRequest> viewOf(const Received& object) {
  ChooseView view;
  const auto number = wholeOf(object, "view", 0, std::numeric_limits<std::uint32_t>::max());
  const auto column_us = wholeOf(object, "column_us", kMinColumnUs, kMaxColumnUs);
  const auto span_us = wholeOf(object, "span_us", 0, kMaxSpanUs);
  for (const auto* each : {&number, &column_us, &span_us}) {
    if (!*each) return tl::unexpected(each->error());
  }
  view.view = static_cast<std::uint32_t>(*number);
  view.column_us = *column_us;
  view.span_us = *span_us;
  const auto* signals = memberOf(object, "signals");
  if (signals == nullptr || !signals->is_array()) return fail("'signals' is missing");
  if (signals->size() > link::kMaxTraceSignals)
    return fail("at most " + std::to_string(link::kMaxTraceSignals) + " signals can be drawn");
  for (const auto& signal : *signals) {
    if (!signal.is_string()) return fail("a signal is a name");
    view.signals.push_back(signal.get<std::string>());
  }
  return view;
}

Result<PageRequest> rangeOf(const Received& object) {
  const auto first = wholeOf(object, "first_column", 0, kMaxExact);
  const auto column_us = wholeOf(object, "column_us", kMinColumnUs, kMaxColumnUs);
  const auto count = wholeOf(object, "count", 1, static_cast<double>(kMaxColumns));
  for (const auto* each : {&first, &column_us, &count}) {
    if (!*each) return tl::unexpected(each->error());
  }
  // Its end in microseconds is a number of a page, too.
  if (static_cast<double>(*first) * static_cast<double>(*column_us) > kMaxExact)
    return fail("'first_column' is out of range");
  return AskRange{*first, *column_us, static_cast<std::uint32_t>(*count)};
}

Result<PageRequest> operationOf(const Received& object) {
  AskRobot ask;
  const auto seq = wholeOf(object, "seq", 0, kMaxExact);
  if (!seq) return tl::unexpected(seq.error());
  ask.seq = *seq;
  ask.operation = textOf(object, "operation");
  ask.target = textOf(object, "target");
  if (ask.operation.empty() || ask.operation.size() >= sizeof(link::Request::operation))
    return fail("'operation' is missing or too long");
  if (const auto known = operationNamed(ask.operation); !known || !stops(*known)) {
    const auto sent_us = wholeOf(object, "sent_us", 0, kMaxExact);
    if (!sent_us) return tl::unexpected(sent_us.error());
    ask.sent = std::chrono::microseconds{*sent_us};
  }
  if (ask.target.size() >= sizeof(link::Request::target)) return fail("'target' is too long");
  if (const auto* values = memberOf(object, "values"); values != nullptr) {
    if (!values->is_object() || values->size() > link::kMaxValues)
      return fail("'values' has too many, or none");
    for (const auto& [name, value] : values->items()) {
      if (!value.is_number() || name.size() >= sizeof(link::NamedValue::name))
        return fail("a value is a number");
      ask.values.emplace_back(name, value.get<double>());
    }
  }
  return ask;
}

Result<PageRequest> clockOf(const Received& object) {
  const auto sent_us = wholeOf(object, "sent_us", 0, kMaxExact);
  if (!sent_us) return tl::unexpected(sent_us.error());
  return TellClock{std::chrono::microseconds{*sent_us}};
}

Result<PageRequest> driveOf(const Received& object) {
  DriveMotor drive;
  const auto stamp = numberAndTimeOf(object);
  if (!stamp) return tl::unexpected(stamp.error());
  drive.seq = stamp->seq;
  drive.sent = stamp->sent;
  drive.motor = textOf(object, "motor");
  if (drive.motor.empty() || drive.motor.size() >= sizeof(link::Name))
    return fail("'motor' is missing or too long");
  const auto word = textOf(object, "mode");
  const auto found = std::find(kHeldModes.begin(), kHeldModes.end(), word);
  if (found == kHeldModes.end()) return fail("'mode' is velocity or current");
  drive.mode = *found == kHeldModes[0] ? ControlMode::kVelocity : ControlMode::kCurrent;
  const auto* value = memberOf(object, "value");
  if (value == nullptr || !value->is_number()) return fail("'value' is missing");
  drive.value = value->get<double>();
  if (!(std::fabs(drive.value) <= kMostHeld)) return fail("'value' is out of range");
  const auto* held = memberOf(object, "held");
  drive.held = held != nullptr && held->is_boolean() && held->get<bool>();
  return drive;
}

Result<PageRequest> recordingOf(const Received& object) {
  const auto number = wholeOf(object, "number", 0, std::numeric_limits<std::uint32_t>::max());
  if (!number) return tl::unexpected(number.error());
  AskRecording ask{.number = static_cast<std::uint32_t>(*number), .name = textOf(object, "name")};
  if (ask.name.empty()) return fail("'name' is missing");
  return ask;
}

Result<PageRequest> pieceOf(const Received& object) {
  const auto number = wholeOf(object, "number", 0, std::numeric_limits<std::uint32_t>::max());
  if (!number) return tl::unexpected(number.error());
  return AskPiece{static_cast<std::uint32_t>(*number)};
}

Result<PageRequest> recordingsOf(const Received& object) {
  const auto seq = wholeOf(object, "seq", 0, kMaxExact);
  if (!seq) return tl::unexpected(seq.error());
  return AskRecordings{*seq};
}

bool isWhole32(const Received& value) {
  return value.is_number_integer() && value.get<double>() >= std::numeric_limits<std::int32_t>::min() &&
         value.get<double>() <= std::numeric_limits<std::int32_t>::max();
}

// Rows of an array, at most so many; null: there is none, or it is too long.
const Received* rowsOf(const Received& object, const char* key, std::size_t most) {
  const auto* rows = memberOf(object, key);
  return rows != nullptr && rows->is_array() && rows->size() <= most ? rows : nullptr;
}

bool addEvent(const Received& row, std::vector<AskWords::Event>& events) {
  if (!row.is_array() || row.size() != 4 || !row[3].is_string()) return false;
  if (!isWhole32(row[0]) || !isWhole32(row[1]) || !isWhole32(row[2])) return false;
  events.push_back({row[0].get<std::int32_t>(), row[1].get<std::int32_t>(), row[2].get<std::int32_t>(),
                    row[3].get<std::string>()});
  return true;
}

bool addFrame(const Received& row, std::size_t buses, std::vector<AskWords::Frame>& frames) {
  if (!row.is_array() || row.size() != 3 || !row[0].is_number_unsigned() || !row[1].is_boolean() ||
      !row[2].is_string())
    return false;
  const auto bus = row[0].get<std::uint64_t>();
  if (bus >= buses) return false;
  frames.push_back({static_cast<std::size_t>(bus), row[1].get<bool>(), row[2].get<std::string>()});
  return true;
}

bool addModels(const Received& row, std::vector<std::vector<std::string>>& buses) {
  if (!row.is_array() || row.size() > link::kMaxMotors) return false;
  buses.emplace_back();
  for (const auto& model : row) {
    if (!model.is_string()) return false;
    buses.back().push_back(model.get<std::string>());
  }
  return true;
}

Result<PageRequest> wordsOf(const Received& object) {
  AskWords ask;
  const auto seq = wholeOf(object, "seq", 0, kMaxExact);
  if (!seq) return tl::unexpected(seq.error());
  ask.seq = *seq;
  const auto* events = rowsOf(object, "events", AskWords::kMostEvents);
  const auto* frames = rowsOf(object, "frames", AskWords::kMostFrames);
  const auto* buses = rowsOf(object, "buses", link::kMaxBuses);
  if (events == nullptr || frames == nullptr || buses == nullptr)
    return fail("'events', 'frames' or 'buses' is missing or too long");
  const bool good =
      std::all_of(events->begin(), events->end(),
                  [&](const auto& row) { return addEvent(row, ask.events); }) &&
      std::all_of(buses->begin(), buses->end(), [&](const auto& row) { return addModels(row, ask.buses); }) &&
      std::all_of(frames->begin(), frames->end(),
                  [&](const auto& row) { return addFrame(row, ask.buses.size(), ask.frames); });
  if (!good) return fail("a row of 'events', 'frames' or 'buses' is none");
  return ask;
}

Result<PageRequest> configOf(const Received& object) {
  const auto seq = wholeOf(object, "seq", 0, kMaxExact);
  if (!seq) return tl::unexpected(seq.error());
  return AskConfig{*seq};
}

Result<PageRequest> configCheckOf(const Received& object) {
  const auto seq = wholeOf(object, "seq", 0, kMaxExact);
  if (!seq) return tl::unexpected(seq.error());
  const auto* text = memberOf(object, "text");
  if (text == nullptr || !text->is_string()) return fail("'text' is missing");
  CheckConfig check{.seq = *seq, .text = text->get<std::string>()};
  if (check.text.size() > CheckConfig::kMostBytes)
    return fail("a page checks at most " + std::to_string(CheckConfig::kMostBytes / 1024) +
                " KiB: check a longer file with `rc10d --check`");
  return check;
}

Result<PageRequest> changeOf(const Received& object, client::FileVerb verb) {
  const auto stamp = numberAndTimeOf(object);
  if (!stamp) return tl::unexpected(stamp.error());
  ChangeFile change{.seq = stamp->seq, .sent = stamp->sent, .verb = verb, .text = {}, .replaces = {}};
  if (verb == client::FileVerb::kRestart) return change;
  const auto* text = memberOf(object, "text");
  if (text == nullptr || !text->is_string()) return fail("'text' is missing");
  change.text = text->get<std::string>();
  change.replaces = textOf(object, "replaces");
  return change;
}

// Keys of a test's message: one that is not known might have been a bound.
constexpr std::array<std::string_view, 22> kTestKeys{"type",
                                                     "schema",
                                                     "seq",
                                                     "sent_us",
                                                     "motor",
                                                     "kind",
                                                     "mode",
                                                     "amplitude",
                                                     "base",
                                                     "seconds",
                                                     "rate_per_s",
                                                     "from_hz",
                                                     "to_hz",
                                                     "linear",
                                                     "max_current_a",
                                                     "max_speed_rpm",
                                                     "min_angle_deg",
                                                     "max_angle_deg",
                                                     "max_feedback_age_ms",
                                                     "stop_at_limits",
                                                     "dead_man_ms",
                                                     "priority"};
// Far beyond any motor, and so are its ranges: those of a test are the library's.
constexpr double kMostNumber = 1e9;
constexpr double kMostPriority = 1e6;
constexpr std::size_t kMostKey = 40;

/// Members of one message, and the first mistake in them.
class Members {
 public:
  explicit Members(const Received& object) : object_(object) {}

  double number(const char* key) {
    const auto found = optionalNumber(key);
    if (!found) wrong(key, "a number");
    return found.value_or(0.0);
  }
  double number(const char* key, double otherwise) { return optionalNumber(key).value_or(otherwise); }
  // Missing or null: it has its default.
  std::optional<double> optionalNumber(const char* key) {
    const auto* member = memberOf(object_, key);
    if (member == nullptr || member->is_null()) return std::nullopt;
    const double value = member->is_number() ? member->get<double>() : std::nan("");
    if (std::fabs(value) <= kMostNumber) return value;
    wrong(key, "a number");
    return std::nullopt;
  }
  std::int64_t whole(const char* key, double least, double most, double otherwise) {
    const double value = number(key, otherwise);
    if (!(value >= least && value <= most)) wrong(key, "a number in its range");
    return value >= least && value <= most ? static_cast<std::int64_t>(value) : 0;
  }
  bool flag(const char* key) {
    const auto* member = memberOf(object_, key);
    if (member != nullptr && !member->is_boolean()) wrong(key, "true or false");
    return member != nullptr && member->is_boolean() && member->get<bool>();
  }
  void wrong(const char* key, const char* wanted) {
    if (mistake_.empty()) mistake_ = std::string{"'"} + key + "' is not " + wanted;
  }
  [[nodiscard]] const std::string& mistake() const noexcept { return mistake_; }

 private:
  const Received& object_;
  std::string mistake_;
};

client::MotionPlan planOf(const Received& object, Members& members) {
  client::MotionPlan plan;
  plan.motor = textOf(object, "motor");
  if (plan.motor.empty() || plan.motor.size() >= sizeof(link::Name)) members.wrong("motor", "a motor's name");
  const auto kind = client::excitationOf(textOf(object, "kind"));
  if (!kind) members.wrong("kind", "step, ramp, sweep or multisine");
  plan.kind = kind.value_or(plan.kind);
  const auto mode = link::modeOf(textOf(object, "mode"));
  if (!mode) members.wrong("mode", "velocity, total_angle or current");
  plan.mode = mode.value_or(plan.mode);
  plan.amplitude = members.number("amplitude");
  plan.base = members.number("base", plan.base);
  plan.time_s = members.optionalNumber("seconds");
  plan.rate_per_s = members.optionalNumber("rate_per_s");
  plan.from_hz = members.number("from_hz", plan.from_hz);
  plan.to_hz = members.number("to_hz", plan.to_hz);
  plan.linear = members.flag("linear");
  plan.max_current_a = members.number("max_current_a");
  plan.max_speed_rpm = members.optionalNumber("max_speed_rpm");
  plan.min_angle_deg = members.optionalNumber("min_angle_deg");
  plan.max_angle_deg = members.optionalNumber("max_angle_deg");
  plan.max_feedback_age_s = members.number("max_feedback_age_ms", plan.max_feedback_age_s * 1e3) / 1e3;
  plan.stop_at_limits = members.flag("stop_at_limits");
  plan.dead_man_ms =
      static_cast<std::int32_t>(members.whole("dead_man_ms", 0, kMostNumber, plan.dead_man_ms));
  return plan;
}

Result<PageRequest> testOf(const Received& object) {
  const auto schema = wholeOf(object, "schema", 0, kMaxExact);
  if (!schema || *schema != StartTest::kSchema)
    return fail("'schema' of a test is " + std::to_string(StartTest::kSchema) +
                " here: load the page anew, it is of another version of rc10-web");
  for (const auto& [key, value] : object.items()) {
    if (std::find(kTestKeys.begin(), kTestKeys.end(), key) == kTestKeys.end())
      return fail("a test has no '" + printable(key.substr(0, kMostKey)) + "'");
  }
  const auto stamp = numberAndTimeOf(object);
  if (!stamp) return tl::unexpected(stamp.error());
  Members members(object);
  StartTest test{.seq = stamp->seq, .sent = stamp->sent, .plan = planOf(object, members)};
  test.priority = static_cast<std::int32_t>(members.whole("priority", -kMostPriority, kMostPriority, 0));
  if (!members.mistake().empty()) return fail(members.mistake());
  return test;
}

Result<PageRequest> renewalOf(const Received& object) {
  const auto stamp = numberAndTimeOf(object);
  if (!stamp) return tl::unexpected(stamp.error());
  return RenewTest{stamp->seq, stamp->sent};
}

Result<PageRequest> endOf(const Received& object) {
  const auto seq = wholeOf(object, "seq", 0, kMaxExact);
  if (!seq) return tl::unexpected(seq.error());
  return EndTest{*seq, textOf(object, "why") == "left" ? TestEnd::kLeft : TestEnd::kStopped};
}

Result<PageRequest> curveOf(const Received& object) {
  const auto seq = wholeOf(object, "seq", 0, kMaxExact);
  const auto first = wholeOf(object, "first", 0, std::numeric_limits<std::uint32_t>::max());
  for (const auto* each : {&seq, &first}) {
    if (!*each) return tl::unexpected(each->error());
  }
  return AskCurve{*seq, static_cast<std::uint32_t>(*first)};
}

// An e-stop counts whatever else its message says, and if it says nothing that can be read.
PageRequest estopOf(std::int64_t seq) {
  return AskRobot{.seq = seq, .operation = toString(Operation::kEstop), .target = {}, .values = {}};
}

}  // namespace

std::int64_t numberOf(std::string_view text) {
  const auto json = Received::parse(text.begin(), text.end(), nullptr, false);
  if (!json.is_object()) return 0;
  return wholeOf(json, json.contains("number") ? "number" : "seq", 0, kMaxExact).value_or(0);
}

Result<PageRequest> parsePageRequest(std::string_view text) {
  // Without exceptions: a mistake gives a discarded value.
  const auto json = Received::parse(text.begin(), text.end(), nullptr, false);
  if (!json.is_object()) {
    if (text.find(R"("estop")") != std::string_view::npos) return estopOf(0);
    return fail("a message is one JSON object");
  }
  const auto type = textOf(json, "type");
  if (operationNamed(type) == Operation::kEstop ||
      operationNamed(textOf(json, "operation")) == Operation::kEstop)
    return estopOf(wholeOf(json, "seq", 0, kMaxExact).value_or(0));
  if (type == "token") return ShowToken{textOf(json, "token")};
  if (type == "view") return viewOf(json);
  if (type == "range") return rangeOf(json);
  if (type == "request") return operationOf(json);
  if (type == "drive") return driveOf(json);
  if (type == "clock") return clockOf(json);
  if (type == "recordings") return recordingsOf(json);
  if (type == "recording") return recordingOf(json);
  if (type == "piece") return pieceOf(json);
  if (type == "words") return wordsOf(json);
  if (type == "config") return configOf(json);
  if (type == "config_check") return configCheckOf(json);
  if (type == "config_install") return changeOf(json, client::FileVerb::kInstall);
  if (type == "config_restart") return changeOf(json, client::FileVerb::kRestart);
  if (type == "test") return testOf(json);
  if (type == "test_renewal") return renewalOf(json);
  if (type == "test_end") return endOf(json);
  if (type == "curve") return curveOf(json);
  return fail("there is no message of this type");
}

}  // namespace rc10::web
