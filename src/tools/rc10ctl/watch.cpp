#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "client/motor_signal.hpp"
#include "client/quantity_text.hpp"
#include "client/sparkline.hpp"
#include "client/state_json.hpp"
#include "client/state_text.hpp"
#include "feed.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

using std::chrono::steady_clock;

constexpr auto kSilence = std::chrono::seconds{1};
constexpr std::size_t kSparkWidth = 60;

struct WatchOptions {
  double hz = 5.0;
  int count = 0;  // 0: until Ctrl-C
  bool once = false;
  std::optional<std::string> spark;
};

// Draws over what was drawn before. Clearing each line's rest, not the screen, does not flicker.
std::string overdrawn(const std::string& text) {
  std::string out = "\x1b[H";
  for (const char c : text) {
    if (c == '\n') out += "\x1b[K";
    out += c;
  }
  return out + "\x1b[J";
}

class Screen {
 public:
  explicit Screen(bool json) : terminal_(!json && ::isatty(STDOUT_FILENO) != 0), separate_(!json) {
    if (terminal_) std::fputs("\x1b[2J", stdout);
  }

  void show(const std::string& text) {
    if (terminal_) {
      std::fputs(overdrawn(text).c_str(), stdout);
    } else {
      // Plain tables one below the other.
      if (separate_ && !first_) std::fputs("\n", stdout);
      std::fputs(text.c_str(), stdout);
    }
    first_ = false;
    std::fflush(stdout);
  }

 private:
  bool terminal_;
  bool separate_;
  bool first_ = true;
};

// One signal over the last pictures.
class Spark {
 public:
  explicit Spark(client::MotorSignal signal) : signal_(std::move(signal)) {}

  std::string line(const link::State& state) {
    values_.add(signal_.of(state));
    return signal_.name + "  " + values_.text(utf8()) + "  " + client::number(values_.newest(), 2) + "  (" +
           client::number(values_.lowest(), 2) + " to " + client::number(values_.highest(), 2) + ")\n";
  }

 private:
  client::MotorSignal signal_;
  client::Sparkline values_{kSparkWidth};
};

std::string picture(const Global& global, const link::Welcome& welcome, const Feed& feed,
                    std::optional<Spark>& spark) {
  if (global.json) return client::stateJson(welcome, *feed.state()) + "\n";
  std::string text = client::stateText(welcome, *feed.state(), feed.diagnostics(), coloured(STDOUT_FILENO));
  if (spark) text += spark->line(*feed.state());
  const auto silent = steady_clock::now() - feed.stateTime();
  if (silent > kSilence) {
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(silent).count();
    text += "rc10d has sent nothing for " + std::to_string(whole) + " s: is it stopped?\n";
  }
  return text;
}

ExitCode watch(const Global& global, const WatchOptions& options) {
  if (!std::isfinite(options.hz)) return complain({"--hz: give a number from 0.1 to 100"}, ExitCode::kUsage);
  auto rc10d = connect(global, link::kStates | link::kDiagnosticsFeed);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  std::optional<Spark> spark;
  if (options.spark) {
    auto signal = client::findSignal(rc10d->welcome(), *options.spark);
    if (!signal) return complain({"--spark: " + signal.error().message}, ExitCode::kUsage);
    spark.emplace(std::move(*signal));
  }
  const int count = options.once ? 1 : options.count;
  Feed feed(*rc10d);
  if (const auto there = feed.awaitState(); !there) {
    return interrupted() ? ExitCode::kOk : complain(there.error(), ExitCode::kFailed);
  }
  // Without them the first picture lacks the buses; they come twice a second.
  if (!global.json) (void)feed.awaitDiagnostics();
  Screen screen(global.json);
  const auto period = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / options.hz));
  auto next = steady_clock::now();
  for (int shown = 0; !interrupted();) {
    if (!feed.pump()) return complain(rc10dEnded(), ExitCode::kFailed);
    if (steady_clock::now() >= next && feed.state() != nullptr) {
      screen.show(picture(global, rc10d->welcome(), feed, spark));
      if (++shown == count) break;
      next = std::max(next + period, steady_clock::now());
    }
    waitReadable(*rc10d, next - steady_clock::now());
  }
  return ExitCode::kOk;
}

}  // namespace

void addWatch(CLI::App& app, Action& action) {
  const auto options = std::make_shared<WatchOptions>();
  auto* verb = app.add_subcommand("watch", "what every motor does, live; ends with Ctrl-C");
  verb->add_option("--hz", options->hz, "pictures a second")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  verb->add_option("--count", options->count, "end after so many pictures; 0: Ctrl-C")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--once", options->once, "one picture, then end");
  verb->add_option("--spark", options->spark, "the last minute or so of one signal as a line: wheel.velocity")
      ->type_name("MOTOR.SIGNAL");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return watch(global, *options); }; });
}

}  // namespace rc10::ctl
