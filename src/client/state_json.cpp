#include "client/state_json.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "app/motor_readings.hpp"
#include "client/json_line.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

template <typename Element, std::size_t N>
std::span<const Element> used(const std::array<Element, N>& array, std::size_t count) {
  return std::span{array}.first(std::min(count, N));
}

Json motorJson(const link::MotorInfo& info, const link::MotorState& motor) {
  Json json{{"name", info.name.view()},
            {"status", toString(motor.status)},
            {"fault", motor.fault},
            {"fault_text", link::faultText(motor.fault)},
            {"limits", listOf(link::limitWords(motor.limits))},
            {"mode", toString(motor.mode)},
            {"owner", motor.owner.view()},
            {"zeroed", motor.zeroed != 0},
            {"command_unit", toString(motor.command_unit)},
            {"acting", toString(motor.acting)},
            {"stop_cause", toString(motor.stop_cause)},
            {"stopped_by", motor.stopped_by.view()}};
  visitMotorReadings(
      [&json](std::string_view name, auto value) { json[std::string(name)] = shortest(value); }, motor);
  return json;
}

Json percentilesJson(const link::Percentiles& p) {
  return {{"p50", shortest(p.p50_us)},
          {"p99", shortest(p.p99_us)},
          {"p999", shortest(p.p999_us)},
          {"max", shortest(p.max_us)}};
}

Json busJson(const link::BusStatus& bus) {
  return {{"name", bus.name.view()},
          {"interface", bus.interface.view()},
          {"state", toString(bus.state)},
          {"predicted_load", shortest(bus.predicted_load)},
          {"predicted_load_worst", shortest(bus.predicted_load_worst)},
          {"measured_load", shortest(bus.measured_load)},
          {"rx_frames", bus.rx_frames},
          {"rx_unmatched", bus.rx_unmatched},
          {"rx_malformed", bus.rx_malformed},
          {"rx_dropped", bus.rx_dropped},
          {"tx_frames", bus.tx_frames},
          {"tx_confirmed", bus.tx_confirmed},
          {"tx_dropped", bus.tx_dropped},
          {"tx_held", bus.tx_held},
          {"rx_foreign", bus.rx_foreign},
          {"error_frames", bus.error_frames},
          {"restarts", bus.restarts},
          {"tec", bus.tec < 0 ? Json(nullptr) : Json(bus.tec)},
          {"rec", bus.rec < 0 ? Json(nullptr) : Json(bus.rec)}};
}

}  // namespace

std::string listJson(const link::Welcome& welcome) {
  Json motors = Json::array();
  for (const auto& motor : used(welcome.motors, welcome.motor_count)) {
    motors.push_back({{"name", motor.name.view()},
                      {"model", motor.model.view()},
                      {"bus", motor.bus.view()},
                      {"id", motor.id},
                      {"modes", listOf(link::modeWords(motor.modes))}});
  }
  return lineOf({{"robot", welcome.robot.view()},
                 {"version", welcome.version.view()},
                 {"config_hash", welcome.config_hash.view()},
                 {"pid", welcome.pid},
                 {"rate_hz", welcome.rate_hz},
                 {"lcm_url", welcome.lcm_url.view()},
                 {"state_hz", welcome.state_hz},
                 {"motors", std::move(motors)}});
}

std::string stateJson(const link::Welcome& welcome, const link::State& state) {
  Json motors = Json::array();
  const auto infos = used(welcome.motors, welcome.motor_count);
  const auto states = used(state.motors, state.motor_count);
  for (std::size_t i = 0; i < std::min(infos.size(), states.size()); ++i) {
    motors.push_back(motorJson(infos[i], states[i]));
  }
  return lineOf({{"robot", welcome.robot.view()},
                 {"utime", state.utime},
                 {"mono_us", state.mono_us},
                 {"tick", state.tick},
                 {"state", toString(state.robot_state)},
                 {"realtime", state.realtime != 0},
                 {"stop_cause", toString(state.stop_cause)},
                 {"stopped_by", state.stopped_by.view()},
                 {"stopped_mono_us", state.stopped_mono_us},
                 {"estop_count", state.estop_count},
                 {"conditions", listOf(link::conditionWords(state.conditions))},
                 {"version", welcome.version.view()},
                 {"config_hash", welcome.config_hash.view()},
                 {"motors", std::move(motors)}});
}

std::string diagnosticsJson(const link::Welcome& welcome, const link::Diagnostics& diagnostics) {
  Json refusals = Json::object();
  for (const auto& refusal : used(diagnostics.refusals, diagnostics.refusal_count)) {
    refusals[std::string(refusal.name.view())] = refusal.count;
  }
  Json counters = Json::object();
  for (const auto& counter : used(diagnostics.counters, diagnostics.counter_count))
    counters[std::string(counter.name.view())] = counter.count;
  Json durations = Json::object();
  for (const auto& each : used(diagnostics.durations, diagnostics.duration_count)) {
    Json json = percentilesJson(each.percentiles);
    json["count"] = each.count;
    durations[std::string(each.name.view())] = std::move(json);
  }
  Json notices = Json::array();
  for (const auto& notice : used(diagnostics.notices, diagnostics.notice_count))
    notices.push_back(notice.view());
  Json buses = Json::array();
  for (const auto& bus : used(diagnostics.buses, diagnostics.bus_count)) buses.push_back(busJson(bus));
  return lineOf({{"robot", welcome.robot.view()},
                 {"utime", diagnostics.utime},
                 {"mono_us", diagnostics.mono_us},
                 {"tick", diagnostics.tick},
                 {"tick_period_us", diagnostics.tick_period_us},
                 {"wake_latency_us", percentilesJson(diagnostics.wake_latency)},
                 {"tick_duration_us", percentilesJson(diagnostics.tick_duration)},
                 {"missed_ticks", diagnostics.missed_ticks},
                 {"page_faults", diagnostics.page_faults},
                 {"events_dropped", diagnostics.events_dropped},
                 {"refusals", std::move(refusals)},
                 {"counters", std::move(counters)},
                 {"durations_us", std::move(durations)},
                 {"notices", std::move(notices)},
                 {"buses", std::move(buses)}});
}

}  // namespace rc10::client
