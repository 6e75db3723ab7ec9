#include "web/checked_config.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "client/json_line.hpp"
#include "config/check/untested_loops.hpp"
#include "config/load_config.hpp"
#include "config/report/report.hpp"
#include "config/report/robot_json.hpp"
#include "web/hidden_tokens.hpp"

namespace rc10::web {
namespace {

using client::Json;

Json checkedMotorJson(const MotorConfig& motor, const BusLoad& load) {
  const auto word = [](FallbackAction action) { return kFallbackWords[static_cast<std::size_t>(action)]; };
  return {{"name", motor.name()},
          {"model", motor.settings.model},
          {"id", motor.settings.id},
          {"command", motorCommandText(motor)},
          {"feedback", motorFeedbackText(motor)},
          {"load", load.worst_case},
          {"direction", motor.settings.direction},
          {"gear_ratio", gearRatioOf(motor.settings, motor.traits())},
          {"zero", motorZeroText(motor)},
          {"on_timeout", word(motor.fallback.on_timeout)},
          {"on_disable", word(motor.fallback.on_disable)},
          {"on_estop", motorEstopText(motor)},
          {"untested_loops", untestedLoops(motor)}};
}

Json checkedBusJson(const BusConfig& bus, int rate_hz) {
  const auto load = predictLoad(bus, rate_hz);
  return {{"name", bus.name},
          {"interface", bus.type == BusType::kSimulated ? "" : bus.interface},
          {"bitrate", bus.bitrate},
          {"data_bitrate", bus.data_bitrate},
          {"load", load.unstuffed},
          {"load_worst", load.worst_case},
          {"motors", motorsJson(bus, rate_hz, checkedMotorJson)}};
}

Json checkedRobotJson(const RobotConfig& config) {
  Json buses = Json::array();
  for (const auto& bus : config.buses) buses.push_back(checkedBusJson(bus, config.rate_hz));
  return {{"name", config.robot},
          {"buses", std::move(buses)},
          {"groups", groupsJson(config)},
          {"report", describe(config)}};
}

std::pair<std::string_view, std::string_view> tokenAndText(std::string_view both) {
  const auto end = std::min(both.find('\n'), both.size());
  return {both.substr(0, end), both.substr(std::min(end + 1, both.size()))};
}

}  // namespace

std::string checkedConfigJson(std::string_view text) {
  const auto outcome = parseRobotConfig(withHashes(std::string{text}), "robot.yaml");
  return client::lineOf({{"errors", problemsJson(outcome.errors)},
                         {"warnings", problemsJson(outcome.warnings)},
                         {"robot", outcome.config ? checkedRobotJson(*outcome.config) : Json(nullptr)}});
}

std::string withToken(std::string_view token, std::string_view text) {
  std::string both;
  if (token.find('\n') == std::string_view::npos) both = token;
  return both.append("\n").append(text);
}

std::string mayReplaceJson(std::string_view token_and_text) {
  const auto [token, text] = tokenAndText(token_and_text);
  return mayReplace(text, token) ? "true" : "false";
}

std::string shownConfigJson(std::string_view token_and_text) {
  const auto [token, text] = tokenAndText(token_and_text);
  const auto shown = showConfig(text, token);
  return client::lineOf({{"text", shown.text}, {"hidden", shown.hidden}, {"why", shown.why}});
}

}  // namespace rc10::web
