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
#include "client/screen_fit.hpp"
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

  /// Its size is another than that of the last picture.
  [[nodiscard]] bool resized() const noexcept {
    return terminal_ && !first_ && screenSize(STDOUT_FILENO) != size_;
  }

  void show(const client::Picture& picture) {
    if (terminal_) {
      // A terminal that was resized has moved what was drawn.
      if (resized()) std::fputs("\x1b[2J", stdout);
      size_ = screenSize(STDOUT_FILENO);
      std::fputs(overdrawn(client::fitted(picture, size_)).c_str(), stdout);
    } else {
      // Plain tables one below the other.
      if (separate_ && !first_) std::fputs("\n", stdout);
      std::fputs((picture.text + picture.modules + picture.below).c_str(), stdout);
    }
    first_ = false;
    std::fflush(stdout);
  }

 private:
  bool terminal_;
  bool separate_;
  bool first_ = true;
  client::ScreenSize size_;
};

// One signal over the last pictures.
class Spark {
 public:
  explicit Spark(client::MotorSignal signal) : signal_(std::move(signal)) {}

  void add(const link::State& state) { values_.add(signal_.of(state)); }

  [[nodiscard]] std::string line() const {
    return signal_.name + "  " + values_.text(utf8()) + "  " + client::number(values_.newest(), 2) + "  (" +
           client::number(values_.lowest(), 2) + " to " + client::number(values_.highest(), 2) + ")\n";
  }

 private:
  client::MotorSignal signal_;
  client::Sparkline values_{kSparkWidth};
};

client::Picture picture(const Global& global, const link::Welcome& welcome, const Feed& feed,
                        const std::optional<Spark>& spark) {
  if (global.json)
    return {
        .text = client::stateJson(welcome, *feed.state()) + "\n", .motors = 0, .modules = {}, .below = {}};
  std::string below;
  std::string modules = client::moduleLines(feed.modules());
  if (spark) below += spark->line();
  const auto silent = steady_clock::now() - feed.stateTime();
  if (silent > kSilence) {
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(silent).count();
    below += "rc10d has sent nothing for " + std::to_string(whole) + " s: is it stopped?\n";
  }
  return {.text = client::stateText(welcome, *feed.state(), feed.diagnostics(), coloured(STDOUT_FILENO)),
          .motors = std::min<std::size_t>(feed.state()->motor_count, welcome.motor_count),
          .modules = std::move(modules),
          .below = std::move(below)};
}

ExitCode watch(const Global& global, const WatchOptions& options) {
  if (!std::isfinite(options.hz)) return complain({"--hz: give a number from 0.1 to 100"}, ExitCode::kUsage);
  if (options.spark && global.json)
    return complain({"--spark draws for people: leave out --json, or --spark"}, ExitCode::kUsage);
  auto rc10d = connect(global, link::kStates | link::kDiagnosticsFeed | link::kModules);
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
  if (!global.json) {
    (void)feed.awaitDiagnostics();
    (void)feed.awaitModules();
  }
  Screen screen(global.json);
  const auto period = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / options.hz));
  auto next = steady_clock::now();
  for (int shown = 0; !interrupted();) {
    if (!feed.pump()) return complain(rc10dEnded(), ExitCode::kFailed);
    const bool due = steady_clock::now() >= next;
    if (feed.state() != nullptr && (due || screen.resized())) {
      if (due && spark) spark->add(*feed.state());
      screen.show(picture(global, rc10d->welcome(), feed, spark));
      if (due && ++shown == count) break;
      if (due) next = std::max(next + period, steady_clock::now());
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
  verb->add_option("--spark", options->spark,
                   "one signal as a line, such as wheel.velocity: its last 60 pictures, 12 s at 5 Hz")
      ->type_name("MOTOR.SIGNAL");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return watch(global, *options); }; });
}

}  // namespace rc10::ctl
