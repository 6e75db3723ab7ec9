#include <cstdio>

#include <CLI/CLI.hpp>

#include "client/state_json.hpp"
#include "client/state_text.hpp"
#include "feed.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

ExitCode stats(const Global& global) {
  auto rc10d = connect(global, link::kDiagnosticsFeed);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  Feed feed(*rc10d);
  if (const auto there = feed.awaitDiagnostics(); !there) return complain(there.error(), ExitCode::kFailed);
  const auto& welcome = rc10d->welcome();
  const auto& diagnostics = *feed.diagnostics();
  std::fputs((global.json ? client::diagnosticsJson(welcome, diagnostics) + "\n"
                          : client::diagnosticsText(welcome, diagnostics))
                 .c_str(),
             stdout);
  return ExitCode::kOk;
}

}  // namespace

void addStats(CLI::App& app, Action& action) {
  app.add_subcommand("stats", "how late and how loaded: timing, buses, refused commands")
      ->callback([&action] { action = stats; });
}

}  // namespace rc10::ctl
