#include "robot_json.hpp"

#include <chrono>
#include <cmath>
#include <string>

#include "config/report/robot_json.hpp"

namespace rc10::ctl {
namespace {

using client::Json;
using client::shortest;

Json threadJson(const ThreadConfig& thread) {
  return {{"priority", thread.priority}, {"cpu", thread.cpu ? Json(*thread.cpu) : Json(nullptr)}};
}

// 0 is "none", or "its own", in the configuration.
Json positiveOrNull(float value) { return value > 0.0F ? Json(shortest(value)) : Json(nullptr); }

Json finiteOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json modesJson(ModeSet modes) {
  Json words = Json::array();
  for (int i = 0; i < kControlModeCount; ++i) {
    const auto mode = static_cast<ControlMode>(i);
    if (modes.contains(mode)) words.push_back(toString(mode));
  }
  return words;
}

std::string_view word(FallbackAction action) { return kFallbackWords[static_cast<std::size_t>(action)]; }

Json motorJson(const MotorConfig& motor, const BusLoad& load) {
  const MotorTraits traits = motor.traits();
  const auto& settings = motor.settings;
  const float effort = effortLimitOf(settings, traits.effort_full_scale);
  const char* const limit = traits.effort == CommandUnit::kVolt ? "voltage_limit_v" : "current_limit_a";
  return {{"name", motor.name()},
          {"model", settings.model},
          {"id", settings.id},
          {"optional", motor.optional},
          {"modes", modesJson(traits.modes)},
          {"direction", settings.direction},
          {"gear_ratio", gearRatioOf(settings, traits)},
          {limit, shortest(effort)},
          {"velocity_limit_rpm", positiveOrNull(settings.velocity_limit_rpm)},
          {"overspeed_rpm", positiveOrNull(motor.guard.overspeed_rpm)},
          {"angle_min_deg", finiteOrNull(motor.shaping.angle_min_deg)},
          {"angle_max_deg", finiteOrNull(motor.shaping.angle_max_deg)},
          {"feedback_hz", settings.feedback_hz},
          {"feedback_timeout_ms",
           std::chrono::duration_cast<std::chrono::milliseconds>(motor.feedback_timeout).count()},
          {"load_worst", load.worst_case},
          {"on_timeout", word(motor.fallback.on_timeout)},
          {"on_disable", word(motor.fallback.on_disable)},
          {"on_estop", word(motor.fallback.on_estop)},
          {"watchdog", traits.watchdog}};
}

Json busJson(const BusConfig& bus, int rate_hz) {
  const auto load = predictLoad(bus, rate_hz);
  const bool simulated = bus.type == BusType::kSimulated;
  return {{"name", bus.name},
          {"interface", simulated ? Json(nullptr) : Json(bus.interface)},
          {"bitrate", bus.bitrate},
          {"data_bitrate", bus.data_bitrate > 0 ? Json(bus.data_bitrate) : Json(nullptr)},
          {"manage_link", bus.manage_link},
          {"predicted_load", load.unstuffed},
          {"predicted_load_worst", load.worst_case},
          {"motors", motorsJson(bus, rate_hz, motorJson)}};
}

Json modulesJson(const RobotConfig& config) {
  Json modules = Json::array();
  for (const auto& module : config.modules) {
    modules.push_back({{"name", module.settings.name},
                       {"type", module.type->name()},
                       {"priority", module.settings.priority}});
  }
  return modules;
}

}  // namespace

Json robotJson(const RobotConfig& config) {
  Json buses = Json::array();
  for (const auto& bus : config.buses) buses.push_back(busJson(bus, config.rate_hz));
  const bool required = config.realtime == RealtimePolicy::kRequired;
  return {{"name", config.robot},
          {"realtime", required ? "required" : "preferred"},
          {"rate_hz", config.rate_hz},
          {"receive", config.receive == ReceivePolicy::kTick ? "tick" : "thread"},
          {"scheduler", threadJson(config.scheduler)},
          {"rx", threadJson(config.rx)},
          {"lcm_url", config.lcm.enabled ? Json(config.lcm.url) : Json(nullptr)},
          {"estop_gpio", config.estop_gpio ? Json(config.estop_gpio->pin.name()) : Json(nullptr)},
          {"heartbeat_gpio", config.heartbeat_gpio ? Json(config.heartbeat_gpio->pin.name()) : Json(nullptr)},
          {"buses", std::move(buses)},
          {"groups", groupsJson(config)},
          {"modules", modulesJson(config)}};
}

}  // namespace rc10::ctl
