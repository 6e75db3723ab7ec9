#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/json_line.hpp"
#include "config/keys/stm32_gains.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

struct Stm32Gains {
  std::vector<std::string> speed;
  std::vector<std::string> angle;
  std::string td_ratio = "0";
  std::string separation_deg = "0";
  std::string tick_ms = "1";
};

constexpr double kMinTickMs = 0.01;
constexpr double kMaxTickMs = 100.0;

ExitCode wrong(const std::string& what) { return complain({what}, ExitCode::kUsage); }

void put(client::Json& json, const ConvertedGains& gains) {
  if (gains.current_limit_a > 0.0F) json["current_limit_a"] = client::shortest(gains.current_limit_a);
  auto& section = json[gains.section];
  if (!gains.type.empty()) section["type"] = gains.type;
  for (const auto& gain : gains.gains) section[std::string{gain.key}] = client::shortest(gain.value);
  for (const auto& note : gains.notes) json["notes"].push_back(note);
}

ExitCode convert(const Global& global, const Stm32Gains& gains) {
  if (gains.speed.empty() && gains.angle.empty())
    return wrong("convert-gains needs --speed, --angle, or both");
  const auto td_ratio = stm32Number(gains.td_ratio);
  if (!td_ratio) return wrong("--td-ratio: " + td_ratio.error().message);
  const auto separation_deg = stm32Number(gains.separation_deg);
  if (!separation_deg) return wrong("--separation: " + separation_deg.error().message);
  const auto tick_ms = stm32Number(gains.tick_ms);
  if (!tick_ms) return wrong("--tick-ms: " + tick_ms.error().message);
  if (*tick_ms < kMinTickMs || *tick_ms > kMaxTickMs) return wrong("--tick-ms: give 0.01 to 100");
  std::vector<ConvertedGains> sections;
  if (!gains.speed.empty()) {
    const auto pid = stm32Pid(gains.speed);
    if (!pid) return wrong("--speed: " + pid.error().message);
    sections.push_back(namedGains(convertSpeedGains(*pid, *td_ratio, *tick_ms / 1000.0)));
  }
  if (!gains.angle.empty()) {
    const auto pid = stm32Pid(gains.angle);
    if (!pid) return wrong("--angle: " + pid.error().message);
    sections.push_back(namedGains(convertAngleGains(*pid, *separation_deg)));
  }
  client::Json json{{"notes", client::Json::array()}};
  std::string text;
  for (const auto& section : sections) {
    put(json, section);
    text += yamlLines(section);
  }
  std::fputs((global.json ? client::lineOf(json) + "\n" : text).c_str(), stdout);
  return ExitCode::kOk;
}

}  // namespace

void addConvertGains(CLI::App& app, Action& action) {
  const auto gains = std::make_shared<Stm32Gains>();
  auto* verb = app.add_subcommand(
      "convert-gains",
      "PID parameters of the STM32 library (mA, per tick) as lines for a configuration (A, per second)");
  const char* order = "KP KI KD [I_OUTLIMIT IS_I_OUTLIMIT OUTPUT_LIMIT DEADBAND]";
  verb->add_option("--speed", gains->speed, "its PID_Incremental: output rpm to mA, as in PID_Param_Config")
      ->expected(3, 7)
      ->type_name(order);
  verb->add_option("--td-ratio", gains->td_ratio, "its td_ratio")->type_name("NUMBER");
  verb->add_option("--angle", gains->angle, "its PID_Position: deg to output rpm, as in PID_Param_Config")
      ->expected(3, 7)
      ->type_name(order);
  verb->add_option("--separation", gains->separation_deg, "its I_SeparaThreshold in degrees")
      ->type_name("DEG");
  verb->add_option("--tick-ms", gains->tick_ms, "how often its speed loop ran")->type_name("MS");
  verb->callback(
      [&action, gains] { action = [gains](const Global& global) { return convert(global, *gains); }; });
}

}  // namespace rc10::ctl
