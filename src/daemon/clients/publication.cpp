#include "daemon/clients/publication.hpp"

#include <unistd.h>

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "app/motor_readings.hpp"
#include "daemon/exchange/events.hpp"
#include "rc10_version.hpp"

namespace rc10 {
namespace {

[[nodiscard]] float toUs(Duration duration) noexcept {
  return std::chrono::duration<float, std::micro>(duration).count();
}

[[nodiscard]] link::Percentiles percentiles(const DurationHistogram& histogram) noexcept {
  return {toUs(histogram.percentile(0.5)), toUs(histogram.percentile(0.99)),
          toUs(histogram.percentile(0.999)), toUs(histogram.max())};
}

[[nodiscard]] std::int64_t monoUs(MonotonicTime time) noexcept {
  return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
}

}  // namespace

float RateMeter::update(MonotonicTime now, std::uint64_t count) noexcept {
  const auto elapsed = now - since_;
  // States that are a second apart may be some microseconds nearer.
  constexpr Duration kSpan = std::chrono::microseconds{999'500};
  if (elapsed < kSpan) return rate_hz_;
  rate_hz_ = since_ == MonotonicTime{} ? 0.0F : static_cast<float>(count - count_) / seconds(elapsed);
  since_ = now;
  count_ = count;
  return rate_hz_;
}

link::Welcome Publication::welcome() const {
  link::Welcome out;
  out.pid = ::getpid();
  out.robot = robot_.robot;
  out.version = kVersion;
  out.config_hash = robot_.config_hash;
  out.lcm_url = robot_.lcm_url;
  out.rate_hz = robot_.rate_hz;
  out.state_hz = robot_.state_hz;
  out.module_count = static_cast<std::uint32_t>(robot_.modules.size());
  for (std::size_t i = 0; i < robot_.modules.size(); ++i) out.modules[i] = robot_.modules[i].name;
  out.motor_count = static_cast<std::uint32_t>(robot_.motors.size());
  for (std::size_t i = 0; i < robot_.motors.size(); ++i) {
    const auto& motor = robot_.motors[i];
    out.motors[i].name = motor.name;
    out.motors[i].model = motor.model;
    out.motors[i].bus = robot_.buses[motor.bus].name;
    out.motors[i].id = motor.id;
    out.motors[i].modes = motor.modes.bits();
  }
  return out;
}

link::ModuleInfo Publication::moduleInfo(std::size_t module) const {
  const auto& in = robot_.modules[module];
  link::ModuleInfo out;
  out.module = static_cast<std::uint32_t>(module);
  out.type = in.type;
  out.input_count = static_cast<std::uint32_t>(in.signals.inputs.size());
  out.output_count = static_cast<std::uint32_t>(in.signals.outputs.size());
  auto place = out.names.begin();
  for (const auto& name : in.signals.inputs) *place++ = name;
  for (const auto& name : in.signals.outputs) *place++ = name;
  return out;
}

void Publication::fill(link::ModuleState& state, std::size_t module, const Snapshot& snapshot,
                       std::int64_t utime) const {
  const auto& in = snapshot.modules[module];
  state.utime = utime;
  state.mono_us = monoUs(snapshot.time);
  state.tick = static_cast<std::int64_t>(snapshot.tick);
  state.module = static_cast<std::uint32_t>(module);
  state.owner = in.owner;
  state.value_count = static_cast<std::uint32_t>(robot_.modules[module].signals.outputs.size());
  state.values = in.outputs;
}

void Publication::fill(link::State& state, const Snapshot& snapshot, std::int64_t utime) {
  state.utime = utime;
  state.mono_us = monoUs(snapshot.time);
  state.tick = static_cast<std::int64_t>(snapshot.tick);
  state.robot_state = snapshot.state;
  state.realtime = robot_.realtime ? 1 : 0;
  state.stop_cause = snapshot.stop.cause;
  state.stopped_by = snapshot.stop.by;
  state.stopped_mono_us = monoUs(snapshot.stopped);
  state.estop_count = static_cast<std::int32_t>(snapshot.estops);
  state.conditions = (robot_.simulated() ? kConditionSimulated : 0U) |
                     (robot_.tuning_locked_at != 0 ? kConditionTuningLocked : 0U) | snapshot.conditions;
  state.motor_count = static_cast<std::uint32_t>(snapshot.motor_count);
  for (std::size_t i = 0; i < snapshot.motor_count; ++i) {
    const auto& in = snapshot.motors[i];
    auto& out = state.motors[i];
    out.status = in.status;
    out.mode = in.target.mode;
    out.command_unit = in.command_unit;
    out.zeroed = in.feedback.zeroed ? 1 : 0;
    out.limits = in.limits;
    out.fault = static_cast<std::int32_t>(in.fault);
    out.feedback_age_us = feedbackAgeUs(in.feedback, snapshot.time);
    out.feedback_age_at_use_us = feedbackAgeUs(in.feedback, snapshot.sent);
    out.command_age_us = commandAgeUs(in, snapshot.time);
    out.target = in.target.value;
    out.acting = in.acting;
    out.stop_cause = in.stop.cause;
    out.stopped_by = in.stop.by;
    visitFeedbackReadings(kCopyReading, out, in.feedback);
    visitTickReadings(kCopyReading, out, in);
    out.feedback_hz = feedback_rates_[i].update(snapshot.time, in.feedback.samples);
    out.owner = in.owner;
  }
}

void Publication::fill(link::BusStatus& out, std::size_t bus, const Snapshot& snapshot,
                       const BusInbox& inbox) {
  const auto& in = snapshot.buses[bus];
  const auto& description = robot_.buses[bus];
  out.name = description.name;
  out.interface = description.interface.empty() ? "simulated" : std::string_view{description.interface};
  out.state = in.state;
  out.tec = static_cast<std::int16_t>(in.tec);
  out.rec = static_cast<std::int16_t>(in.rec);
  out.predicted_load = description.predicted_load;
  out.predicted_load_worst = description.predicted_load_worst;
  const auto& counters = in.counters;
  // The bits of FD's data phase are shorter.
  const double data_bits = static_cast<double>(counters.rx_data_bits + counters.tx_data_bits);
  const double shorter =
      description.data_bitrate > 0.0 ? description.bitrate / description.data_bitrate : 1.0;
  const auto bits = counters.rx_bits + counters.tx_bits + static_cast<std::uint64_t>(data_bits * shorter);
  out.measured_load = bit_rates_[bus].update(snapshot.time, bits) / static_cast<float>(description.bitrate);
  out.rx_frames = static_cast<std::int64_t>(counters.rx_frames);
  out.rx_unmatched = static_cast<std::int64_t>(counters.rx_unmatched);
  out.rx_malformed =
      static_cast<std::int64_t>(counters.rx_malformed + inbox.malformed.load(std::memory_order_relaxed));
  out.rx_dropped = static_cast<std::int64_t>(inbox.dropped.load(std::memory_order_relaxed));
  out.tx_frames = static_cast<std::int64_t>(counters.tx_frames);
  out.tx_confirmed = static_cast<std::int64_t>(inbox.confirmed.load(std::memory_order_relaxed));
  out.tx_dropped = static_cast<std::int64_t>(counters.tx_dropped);
  out.rx_foreign = static_cast<std::int64_t>(counters.rx_foreign);
  out.tx_held = static_cast<std::int64_t>(counters.tx_held);
  out.error_frames = static_cast<std::int64_t>(in.error_frames);
  out.restarts = static_cast<std::int64_t>(in.restarts);
}

void Publication::fillCounters(link::Diagnostics& out, const Snapshot& snapshot, const LateTickCauses& late) {
  static_assert(2 + kLateCauses + LateTickCauses::kMaxTakers <= link::kMaxCounters);
  out.counter_count = 0;
  const auto add = [&out](std::string_view name, std::uint64_t count) {
    out.counters[out.counter_count].name = name;
    out.counters[out.counter_count].count = static_cast<std::int64_t>(count);
    ++out.counter_count;
  };
  add("e-stops", snapshot.estops);
  add("commands expired in the ring", snapshot.expired_commands);
  for (std::size_t i = 0; i < kLateCauses; ++i)
    add(kLateCauseWords[i].counter, late.count(static_cast<LateCause>(i)));
  for (const auto& taker : late.takers()) add(std::string(kTakenByWords.counter) + taker.name, taker.count);
}

void Publication::fillDurations(link::Diagnostics& out, const Measured& measured) const {
  constexpr std::size_t kOfAll = 3;  // commands, those of further clients, states
  static_assert(kOfAll + ClientAges::kNamed + kMaxBuses + kMaxMotors <= link::kMaxDurations);
  out.duration_count = 0;
  const auto add = [&out](std::string_view name, const DurationHistogram& histogram) {
    out.durations[out.duration_count].name = name;
    out.durations[out.duration_count].count = static_cast<std::int64_t>(histogram.count());
    out.durations[out.duration_count].percentiles = percentiles(histogram);
    ++out.duration_count;
  };
  const auto& ages = measured.ages;
  add("command to frames", ages.command);
  for (std::size_t i = 0; i < ages.clients.count(); ++i)
    add("command of " + std::string(ages.clients.name(i).view()), ages.clients.of(i));
  if (ages.clients.ofOthers().max() > Duration{}) add("command of further clients", ages.clients.ofOthers());
  add("feedback to clients", measured.state_ages);
  for (std::size_t bus = 0; bus < robot_.buses.size(); ++bus) {
    DurationHistogram all;
    for (std::size_t i = 0; i < ages.feedback.size(); ++i)
      if (robot_.motors[i].bus == bus) all.add(ages.feedback[i]);
    add("feedback at use, bus " + robot_.buses[bus].name, all);
  }
  for (std::size_t i = 0; i < ages.feedback.size(); ++i)
    add("feedback at use: " + robot_.motors[i].name, ages.feedback[i]);
}

void Publication::fill(link::Diagnostics& out, const Snapshot& snapshot, const Measured& measured,
                       std::int64_t utime) {
  out.utime = utime;
  out.mono_us = monoUs(snapshot.time);
  out.tick = static_cast<std::int64_t>(snapshot.tick);
  out.tick_period_us = 1'000'000 / robot_.rate_hz;
  out.wake_latency = percentiles(measured.timing.wake_latency);
  out.tick_duration = percentiles(measured.timing.duration);
  out.missed_ticks = static_cast<std::int64_t>(snapshot.missed_ticks);
  out.page_faults = static_cast<std::int64_t>(measured.page_faults);
  out.events_dropped = static_cast<std::int64_t>(snapshot.events_dropped);
  out.refusal_count = 0;
  const auto add = [&out](std::string_view name, std::uint64_t count) {
    out.refusals[out.refusal_count].name = name;
    out.refusals[out.refusal_count].count = static_cast<std::int64_t>(count);
    ++out.refusal_count;
  };
  for (std::size_t i = 1; i < kCommandRefusalCount; ++i) {
    const auto reason = static_cast<CommandRefusal>(i);
    // Expired on arrival and expired in the ring are one reason to a user.
    add(toString(reason), measured.admission.counts()[i] +
                              (reason == CommandRefusal::kExpired ? snapshot.expired_commands : 0));
  }
  add("not owner", snapshot.refused_commands + snapshot.refused_signals);
  add("setpoint skipped", snapshot.skipped_setpoints);
  fillCounters(out, snapshot, measured.late);
  fillDurations(out, measured);
  out.notice_count = 0;
  for (const auto& notices : {measured.notices, std::span<const std::string>(robot_.notices)}) {
    for (const auto& notice : notices.first(std::min(notices.size(), link::kMaxNotices - out.notice_count)))
      out.notices[out.notice_count++] = notice;
  }
  out.bus_count = static_cast<std::uint32_t>(snapshot.bus_count);
  for (std::size_t i = 0; i < snapshot.bus_count; ++i) fill(out.buses[i], i, snapshot, measured.inboxes[i]);
}

link::Event Publication::refusal(CommandRefusal reason, const link::Name& client, MonotonicTime now,
                                 std::int64_t utime, const std::string& why) {
  link::Event out;
  out.utime = utime;
  out.mono_us = monoUs(now);
  out.severity = Severity::kWarning;
  out.code = static_cast<std::int32_t>(EventCode::kCommandRefused);
  out.source = "robot";
  out.client = client;
  const auto* verdict = reason == CommandRefusal::kUnusedField ? "accepted" : "refused";
  out.text = fmt::format("command of '{}' {}: {}", client.view(), verdict,
                         why.empty() ? std::string_view{describe(reason)} : std::string_view{why});
  return out;
}

link::Event Publication::event(const Event& event, std::int64_t utime) const {
  link::Event out;
  out.utime = utime;
  out.mono_us = monoUs(event.time);
  out.severity = event.severity;
  out.code = static_cast<std::int32_t>(event.code);
  const auto index = static_cast<std::size_t>(event.source);
  if (event.code == EventCode::kEstopInput) {
    const bool enabling = event.value == static_cast<std::int32_t>(ContactState::kReleased);
    out.source = enabling || robot_.estop_input.empty() ? robot_.enabling_input : robot_.estop_input;
  } else if (event.code == EventCode::kModeInput) {
    out.source = robot_.mode_input;
  } else if (event.source < 0) {
    out.source = "robot";
  } else if (isOfBus(event.code)) {
    out.source = index < robot_.buses.size() ? std::string_view{robot_.buses[index].name} : "?";
  } else if (isOfModule(event.code)) {
    out.source = index < robot_.modules.size() ? std::string_view{robot_.modules[index].name} : "?";
  } else {
    out.source = index < robot_.motors.size() ? std::string_view{robot_.motors[index].name} : "?";
  }
  out.client = event.client;
  out.text = describe(event);
  if (event.code == EventCode::kSetpointSkipped && SkipReason{event.value} == SkipReason::kFirstStep &&
      index < robot_.motors.size())
    out.text = fmt::format("{}: within {:.6g} deg", describe(event), robot_.motors[index].max_first_step_deg);
  if (event.code == EventCode::kModule && index < robot_.modules.size()) {
    const auto& events = robot_.modules[index].signals.events;
    const auto place = static_cast<std::size_t>(event.value);
    if (place < events.size()) out.text = events[place].text;
  }
  return out;
}

}  // namespace rc10
