#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/printable.hpp"
#include "client/json_line.hpp"
#include "client/request_call.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

// Some settings, each written several times, and stored.
constexpr Duration kConfigurePatience = std::chrono::seconds{12};

struct ConfigureOptions {
  std::string motor;
  std::vector<std::string> settings;
  bool list = false;
  bool no_save = false;
  bool yes = false;
};

Result<link::NamedValue> valueIn(const std::string& text) {
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
  char* end = nullptr;
  const double value = std::strtod(number.c_str(), &end);
  if (name.empty() || number.empty() || *end != '\0' || !std::isfinite(value))
    return fail("'" + text + "': give KEY=NUMBER, such as timeout_ms=100");
  if (name.size() >= sizeof(link::NamedValue::name)) return fail("there is no setting '" + name + "'");
  return link::NamedValue{.name = std::string_view{name}, .value = value};
}

Result<link::Request> configureRequest(const ConfigureOptions& options) {
  link::Request request;
  if (options.motor.empty() || options.motor.size() >= sizeof(link::Name))
    return fail("'" + options.motor + "' is not the name of a motor: see `rc10ctl list`");
  request.target = options.motor;
  if (options.list) {
    request.operation = toString(Operation::kDriveSettings);
    return request;
  }
  request.operation = toString(Operation::kConfigure);
  if (options.settings.empty())
    return fail("name a setting: `rc10ctl configure-drive " + options.motor +
                " --list` tells which there are");
  if (options.settings.size() >= link::kMaxValues) return fail("too many settings at once: do it in parts");
  for (const auto& text : options.settings) {
    auto value = valueIn(text);
    if (!value) return tl::unexpected(value.error());
    request.values[request.value_count++] = *value;
  }
  request.values[request.value_count++] = {.name = std::string_view{"save"},
                                           .value = options.no_save ? 0.0 : 1.0};
  return request;
}

// Flash lasts beyond power-off, and wears: the name is asked for, as the motor may be the wrong one.
bool confirmed(const Global& global, const ConfigureOptions& options) {
  if (options.no_save || options.yes) return true;
  std::string what;
  for (const auto& text : options.settings) what += (what.empty() ? "" : ", ") + text;
  std::FILE* const person = global.json ? stderr : stdout;
  std::fprintf(person, "write %s to the flash of %s? Type its name: ", what.c_str(), options.motor.c_str());
  std::fflush(person);
  std::string typed;
  if (!std::getline(std::cin, typed)) std::fputs("\n", person);
  return typed == options.motor;
}

// Line by line: the message has more than one.
void printMessage(std::string_view text) {
  while (!text.empty()) {
    const auto end = text.find('\n');
    std::printf("%s\n", printable(text.substr(0, end)).c_str());
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
}

// "NAME MIN to MAX[, whole]" is a setting; the last line says what sets everything else.
void printSettings(const std::string& motor, std::string_view text) {
  client::Json settings = client::Json::array();
  client::Json notes = client::Json::array();
  std::istringstream lines{std::string{text}};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words{line};
    std::string name;
    std::string to;
    double min = 0.0;
    double max = 0.0;
    if (words >> name >> min >> to >> max && to == "to")
      settings.push_back({{"name", name}, {"min", min}, {"max", max}, {"whole", line.ends_with(", whole")}});
    else
      notes.push_back(line);
  }
  std::puts(client::lineOf({{"motor", motor}, {"settings", std::move(settings)}, {"notes", std::move(notes)}})
                .c_str());
}

ExitCode configure(const Global& global, const ConfigureOptions& options) {
  const auto request = configureRequest(options);
  if (!request) return complain(request.error(), ExitCode::kUsage);
  auto rc10d = connect(global);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  if (!options.list && !confirmed(global, options))
    return complain({"nothing was written"}, ExitCode::kFailed);
  const auto response = RequestCall(*rc10d, kClientName).call(*request, kConfigurePatience);
  if (!response) return complain(response.error(), ExitCode::kFailed);
  if (response->status != link::ResponseStatus::kOk)
    return complain({printable(response->message.view())}, ExitCode::kFailed);
  if (!global.json)
    printMessage(response->message.view());
  else if (options.list)
    printSettings(options.motor, response->message.view());
  else
    std::puts(client::lineOf({{"motor", options.motor}, {"message", response->message.view()}}).c_str());
  return ExitCode::kOk;
}

}  // namespace

void addConfigureDrive(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ConfigureOptions>();
  auto* verb = app.add_subcommand(
      "configure-drive", "writes settings into a drive's own memory, after asking; not while it is ACTIVE");
  verb->add_option("motor", options->motor, "name of the motor")->required()->type_name("MOTOR");
  verb->add_option("settings", options->settings, "what to write, such as timeout_ms=100")
      ->type_name("KEY=VALUE");
  verb->add_flag("--list", options->list, "what can be written to this drive; writes nothing");
  verb->add_flag("--no-save", options->no_save, "until the drive is without power: not to its flash");
  verb->add_flag("--yes", options->yes, "do not ask");
  verb->callback([&action, options] {
    action = [options](const Global& global) { return configure(global, *options); };
  });
}

}  // namespace rc10::ctl
