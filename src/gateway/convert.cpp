#include "gateway/convert.hpp"

#include <algorithm>

#include "app/motor_readings.hpp"
#include "link/words.hpp"

namespace rc10::gateway {
namespace {

template <std::size_t N>
void assign(std::string& out, const link::Text<N>& text) {
  out.assign(text.view());
}

// Makes room for the used part of `in` in `out` and returns that part.
template <typename In, std::size_t N, typename Out>
std::span<const In> prepare(const std::array<In, N>& in, std::size_t count, std::vector<Out>& out) {
  const auto used = std::span{in}.first(std::min(count, N));
  out.resize(used.size());
  return used;
}

template <typename Out>
std::int32_t countOf(const std::vector<Out>& elements) noexcept {
  return static_cast<std::int32_t>(elements.size());
}

void convert(const link::MotorState& in, motor_state_t& out) {
  out.status = static_cast<std::int8_t>(in.status);
  out.fault = in.fault;
  out.fault_text = link::faultText(in.fault);
  out.limits = static_cast<std::int32_t>(in.limits);
  out.mode = static_cast<std::int8_t>(in.mode);
  assign(out.owner, in.owner);
  out.acting = static_cast<std::int8_t>(in.acting);
  out.stop_cause = static_cast<std::int8_t>(in.stop_cause);
  assign(out.stopped_by, in.stopped_by);
  out.zeroed = static_cast<std::int8_t>(in.zeroed != 0);
  out.command_unit = static_cast<std::int8_t>(in.command_unit);
  visitMotorReadings(kCopyReading, out, in);
}

void convert(const link::BusStatus& in, bus_state_t& out) {
  assign(out.name, in.name);
  assign(out.interface_name, in.interface);
  out.state = static_cast<std::int8_t>(in.state);
  out.predicted_load = in.predicted_load;
  out.predicted_load_worst = in.predicted_load_worst;
  out.measured_load = in.measured_load;
  out.rx_frames = in.rx_frames;
  out.rx_unmatched = in.rx_unmatched;
  out.rx_malformed = in.rx_malformed;
  out.rx_foreign = in.rx_foreign;
  out.rx_dropped = in.rx_dropped;
  out.tx_frames = in.tx_frames;
  out.tx_confirmed = in.tx_confirmed;
  out.tx_dropped = in.tx_dropped;
  out.tx_held = in.tx_held;
  out.error_frames = in.error_frames;
  out.restarts = in.restarts;
  out.tec = in.tec;
  out.rec = in.rec;
}

template <std::size_t N>
std::int32_t convert(const std::array<link::Counter, N>& in, std::size_t count, std::vector<counter_t>& out) {
  const auto used = prepare(in, count, out);
  for (std::size_t i = 0; i < used.size(); ++i) {
    assign(out[i].name, used[i].name);
    out[i].count = used[i].count;
  }
  return countOf(out);
}

void convert(const link::Durations& in, durations_t& out) {
  assign(out.name, in.name);
  out.count = in.count;
  out.p50_us = in.percentiles.p50_us;
  out.p99_us = in.percentiles.p99_us;
  out.p999_us = in.percentiles.p999_us;
  out.max_us = in.percentiles.max_us;
}

}  // namespace

void convert(const link::Welcome& welcome, const link::State& state, robot_state_t& out) {
  out.utime = state.utime;
  out.mono_us = state.mono_us;
  out.tick = state.tick;
  out.state = static_cast<std::int8_t>(state.robot_state);
  out.stop_cause = static_cast<std::int8_t>(state.stop_cause);
  assign(out.stopped_by, state.stopped_by);
  out.stopped_mono_us = state.stopped_mono_us;
  out.estop_count = state.estop_count;
  out.conditions = static_cast<std::int32_t>(state.conditions);
  out.realtime = static_cast<std::int8_t>(state.realtime != 0);
  assign(out.version, welcome.version);
  assign(out.config_hash, welcome.config_hash);
  // A motor without a name is of no use to anyone.
  const auto named = std::min<std::size_t>(state.motor_count, welcome.motor_count);
  const auto motors = prepare(state.motors, named, out.motors);
  for (std::size_t i = 0; i < motors.size(); ++i) {
    assign(out.motors[i].name, welcome.motors[i].name);
    convert(motors[i], out.motors[i]);
  }
  out.motor_count = countOf(out.motors);
}

void convert(const link::Diagnostics& diagnostics, diagnostics_t& out) {
  out.utime = diagnostics.utime;
  out.mono_us = diagnostics.mono_us;
  out.tick = diagnostics.tick;
  out.tick_period_us = diagnostics.tick_period_us;
  out.wake_latency_p50_us = diagnostics.wake_latency.p50_us;
  out.wake_latency_p99_us = diagnostics.wake_latency.p99_us;
  out.wake_latency_p999_us = diagnostics.wake_latency.p999_us;
  out.wake_latency_max_us = diagnostics.wake_latency.max_us;
  out.tick_duration_p50_us = diagnostics.tick_duration.p50_us;
  out.tick_duration_p99_us = diagnostics.tick_duration.p99_us;
  out.tick_duration_p999_us = diagnostics.tick_duration.p999_us;
  out.tick_duration_max_us = diagnostics.tick_duration.max_us;
  out.missed_ticks = diagnostics.missed_ticks;
  out.page_faults = diagnostics.page_faults;
  out.events_dropped = diagnostics.events_dropped;
  out.refusal_count = convert(diagnostics.refusals, diagnostics.refusal_count, out.refusals);
  out.counter_count = convert(diagnostics.counters, diagnostics.counter_count, out.counters);
  const auto durations = prepare(diagnostics.durations, diagnostics.duration_count, out.durations);
  for (std::size_t i = 0; i < durations.size(); ++i) convert(durations[i], out.durations[i]);
  out.duration_count = countOf(out.durations);
  const auto notices = prepare(diagnostics.notices, diagnostics.notice_count, out.notices);
  for (std::size_t i = 0; i < notices.size(); ++i) assign(out.notices[i], notices[i]);
  out.notice_count = countOf(out.notices);
  const auto buses = prepare(diagnostics.buses, diagnostics.bus_count, out.buses);
  for (std::size_t i = 0; i < buses.size(); ++i) convert(buses[i], out.buses[i]);
  out.bus_count = countOf(out.buses);
}

void convert(const link::Event& event, event_t& out) {
  out.utime = event.utime;
  out.mono_us = event.mono_us;
  out.severity = static_cast<std::int8_t>(event.severity);
  out.code = event.code;
  assign(out.source, event.source);
  assign(out.client, event.client);
  assign(out.text, event.text);
}

void convert(const link::Response& response, std::int64_t utime, response_t& out) {
  out.utime = utime;
  assign(out.client, response.client);
  out.session = static_cast<std::int64_t>(response.session);
  out.seq = response.seq;
  out.status = static_cast<std::int8_t>(response.status);
  assign(out.message, response.message);
  const auto values = prepare(response.values, response.value_count, out.values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    assign(out.values[i].name, values[i].name);
    out.values[i].value = values[i].value;
  }
  out.value_count = countOf(out.values);
}

void convert(const link::ModuleInfo& info, const link::ModuleState& state, signals_t& out) {
  out.utime = state.utime;
  out.mono_us = state.mono_us;
  assign(out.client, state.owner);
  out.session = 0;
  out.seq = state.tick;
  out.priority = 0;
  out.validity_ms = 0;
  const auto count = std::min<std::size_t>({state.value_count, info.output_count, link::kMaxSignals});
  out.names.resize(count);
  out.values.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    assign(out.names[i], info.names[info.input_count + i]);
    out.values[i] = state.values[i];
  }
  out.count = countOf(out.values);
}

}  // namespace rc10::gateway
