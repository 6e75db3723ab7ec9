#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/printable.hpp"
#include "app/text_table.hpp"
#include "client/json_line.hpp"
#include "client/request_call.hpp"
#include "config/yaml/number_text.hpp"
#include "named_value.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

using client::Json;

struct GainsOptions {
  std::string motor;
  std::vector<std::string> settings;
  bool save = false;
};

using Gains = std::span<const link::NamedValue>;

Gains gainsIn(const link::Response& response) {
  return std::span(response.values).first(std::min<std::size_t>(response.value_count, link::kMaxValues));
}

Result<link::Request> gainsRequest(const GainsOptions& options) {
  link::Request request;
  if (options.motor.empty() || options.motor.size() >= sizeof(link::Name))
    return fail("'" + options.motor + "' is not the name of a motor: see `rc10ctl list`");
  request.target = options.motor;
  request.operation = toString(options.settings.empty() ? Operation::kGetConfig : Operation::kSetGains);
  if (options.settings.size() > link::kMaxValues) return fail("too many gains at once: do it in parts");
  for (const auto& text : options.settings) {
    const auto value = namedValue(text, "velocity.kp=0.8");
    if (!value) return tl::unexpected(value.error());
    request.values[request.value_count++] = *value;
  }
  return request;
}

/// rc10d's answer; an error if it did not do it.
Result<link::Response> ask(RequestCall& call, const link::Request& request) {
  auto response = call.call(request);
  if (response && response->status != link::ResponseStatus::kOk)
    return fail(printable(response->message.view()));
  return response;
}

Json jsonOf(Gains gains) {
  Json json = Json::object();
  for (const auto& gain : gains) json[std::string{gain.name.view()}] = gain.value;
  return json;
}

std::vector<std::string> linesOf(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const auto end = text.find('\n');
    lines.push_back(printable(text.substr(0, end)));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  return lines;
}

/// Output: the gains, those before a change, the lines for the robot's file.
struct Shown {
  std::string motor;
  Gains gains;
  std::optional<Gains> before;
  std::optional<std::vector<std::string>> lines;
};

void printGainsJson(const Shown& shown) {
  Json json{{"motor", shown.motor}};
  if (shown.before) json["before"] = jsonOf(*shown.before);
  json["gains"] = jsonOf(shown.gains);
  if (shown.lines) json["lines"] = *shown.lines;
  std::printf("%s\n", client::lineOf(json).c_str());
}

void printTable(const Shown& shown) {
  using Align = TextTable::Align;
  TextTable table({{"GAIN"}, {shown.before ? "BEFORE" : "VALUE", Align::kRight}, {"AFTER", Align::kRight}});
  for (std::size_t i = 0; i < shown.gains.size(); ++i) {
    const double now = shown.gains[i].value;
    const double then = shown.before && i < shown.before->size() ? (*shown.before)[i].value : now;
    table.add({printable(shown.gains[i].name.view()), numberText(then), then == now ? "" : numberText(now)});
  }
  std::printf("%s", table.text().c_str());
}

void printGainsText(const Shown& shown) {
  if (shown.before || !shown.lines) printTable(shown);
  if (shown.before && !shown.lines)
    std::printf("until rc10d restarts; `rc10ctl gains %s --save` prints the lines for the robot's file\n",
                printable(shown.motor).c_str());
  if (!shown.lines) return;
  std::printf("# %s: in place of the loops that it has in the robot's file\n",
              printable(shown.motor).c_str());
  for (const auto& line : *shown.lines) std::printf("%s\n", line.c_str());
}

ExitCode gains(const Global& global, const GainsOptions& options) {
  const auto request = gainsRequest(options);
  if (!request) return complain(request.error(), ExitCode::kUsage);
  auto rc10d = connect(global);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  RequestCall call(*rc10d, kClientName);
  const auto told = gainsRequest({.motor = options.motor, .settings = {}});
  const auto before = told ? ask(call, *told) : tl::unexpected(told.error());
  if (!before) return complain(before.error(), ExitCode::kFailed);
  const bool changes = !options.settings.empty();
  const auto changed = changes ? ask(call, *request) : before;
  if (!changed) return complain(changed.error(), ExitCode::kFailed);
  // The lines are told by get_config.
  const auto after = changes && options.save ? ask(call, *told) : before;
  if (!after) return complain(after.error(), ExitCode::kFailed);
  Shown shown{options.motor, gainsIn(*changed), {}, {}};
  if (changes) shown.before = gainsIn(*before);
  if (options.save) shown.lines = linesOf(after->message.view());
  global.json ? printGainsJson(shown) : printGainsText(shown);
  return ExitCode::kOk;
}

}  // namespace

void addGains(CLI::App& app, Action& action) {
  const auto options = std::make_shared<GainsOptions>();
  auto* verb = app.add_subcommand(
      "gains", "shows the gains of a motor's loops, or changes them while it runs; a restart forgets them");
  verb->add_option("motor", options->motor, "name of the motor")->required()->type_name("MOTOR");
  verb->add_option("settings", options->settings,
                   "what to change: keys of the configuration, such as velocity_pid.kp_a_per_rpm=0.8 or, in "
                   "brief, velocity.kp=0.8; all of them or none")
      ->type_name("GAIN=VALUE");
  verb->add_flag("--save", options->save, "prints the lines for the motor in the robot's file");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return gains(global, *options); }; });
}

}  // namespace rc10::ctl
