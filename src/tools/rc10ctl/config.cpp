#include <poll.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "app/nearest.hpp"
#include "app/whole_file.hpp"
#include "client/file_request.hpp"
#include "client/find_robot.hpp"
#include "client/json_line.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

using client::FileRequest;
using client::FileVerb;

// Without a name that of the one that runs; if none runs, the file of rc10d.service.
std::string robotName(const Global& global) {
  if (global.robot) return *global.robot;
  const auto found = findRobot(std::nullopt);
  return found ? found->robot : "robot";
}

Result<client::FileAnswer> ask(const FileRequest& request) {
  using std::chrono::steady_clock;
  auto call = client::FileCall::send(request, steady_clock::now());
  if (!call) return tl::unexpected(call.error());
  for (;;) {
    if (auto answer = call->poll(steady_clock::now())) return std::move(*answer);
    if (interrupted()) return fail("interrupted; rc10-config goes on with what was asked for");
    pollfd entry{.fd = call->descriptor(), .events = POLLIN, .revents = 0};
    (void)::poll(&entry, 1, 1000);
  }
}

std::optional<FileVerb> verbOf(std::string_view word) {
  for (const auto verb : {FileVerb::kCheck, FileVerb::kInstall, FileVerb::kRestart})
    if (word == toString(verb)) return verb;
  return std::nullopt;
}

struct ConfigOptions {
  std::string what;
  std::string file;
};

ExitCode config(const Global& global, const ConfigOptions& options) {
  const auto verb = verbOf(options.what);
  if (!verb) {
    return complain({"'" + options.what + "' is not check, install or restart" +
                     didYouMean(options.what, {"check", "install", "restart"})},
                    ExitCode::kUsage);
  }
  if ((*verb == FileVerb::kRestart) != options.file.empty()) {
    return complain(
        {*verb == FileVerb::kRestart ? "`rc10ctl config restart` takes no file"
                                     : "name the file: `rc10ctl config " + options.what + " FILE`"},
        ExitCode::kUsage);
  }
  FileRequest request{.verb = *verb, .robot = robotName(global), .replaces = {}, .text = {}};
  if (*verb != FileVerb::kRestart) {
    auto text = readWholeFile(options.file);
    if (!text)
      return complain({"cannot read " + options.file + ": is there such a file, and may you read it?"},
                      ExitCode::kUsage);
    request.text = std::move(*text);
  }
  const auto answer = ask(request);
  if (!answer) return complain(answer.error(), ExitCode::kFailed);
  auto message = answer->message;
  if (message.ends_with('\n')) message.pop_back();
  if (!answer->done) return complain({message}, ExitCode::kFailed);
  std::puts(global.json ? client::lineOf({{"verb", options.what}, {"message", message}}).c_str()
                        : message.c_str());
  return ExitCode::kOk;
}

}  // namespace

void addConfig(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ConfigOptions>();
  auto* verb = app.add_subcommand("config",
                                  "checks and installs the robot's file, restarts rc10d: by the root helper");
  verb->add_option("what", options->what, "check, install or restart")->required()->type_name("WHAT");
  verb->add_option("file", options->file, "the text, of check and install")->type_name("FILE");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return config(global, *options); }; });
}

}  // namespace rc10::ctl
