#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/printable.hpp"
#include "ask.hpp"
#include "client/find_motor.hpp"
#include "client/first_spin.hpp"
#include "client/hand_turn.hpp"
#include "client/quantity_text.hpp"
#include "config/check/untested_loops.hpp"
#include "drive.hpp"
#include "feed.hpp"
#include "link/at_end.hpp"
#include "link/until_its_end.hpp"
#include "link/words.hpp"
#include "require_mode.hpp"
#include "running_config.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

constexpr double kMostCurrentA = 20.0;
// docs/lcm.md: reference of the angle lost.
constexpr std::int32_t kReferenceLost = 102;
/// Some periods of the slowest state_hz that it takes, on a busy computer.
constexpr Duration kShown = std::chrono::seconds{2};

struct CommissionOptions {
  std::string motor;
  std::string limit = "1A";
  double over_speed_rpm = 60.0;
};

// "1A", "0.5 A", "500mA", "1".
Result<double> currentIn(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  std::string unit(end);
  while (!unit.empty() && unit.front() == ' ') unit.erase(0, 1);
  const double amperes = unit == "mA" ? value / 1000.0 : value;
  if (end == text.c_str() || (!unit.empty() && unit != "A" && unit != "mA") ||
      !(amperes > 0.0 && amperes <= kMostCurrentA))
    return fail("--limit " + text + ": give a current like 1A or 500mA, at most 20A");
  return amperes;
}

// Waits for a line while the states go on coming. Nothing: Ctrl-C, or nobody is there.
std::optional<std::string> waitLine(Feed& feed) {
  std::fflush(stdout);
  while (!interrupted()) {
    pollfd entry{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    // Text typed ahead is in the stream already.
    if (std::cin.rdbuf()->in_avail() > 0 || ::poll(&entry, 1, 50) > 0) {
      std::string line;
      return std::getline(std::cin, line) && feed.pump() ? std::optional{line} : std::nullopt;
    }
    if (!feed.pump()) return std::nullopt;
  }
  return std::nullopt;
}

// Empty, or the names of motors that may move.
std::string motorsOn(const link::Welcome& welcome, const link::State& state) {
  std::string names;
  for (std::size_t i = 0; i < std::min<std::size_t>(state.motor_count, welcome.motor_count); ++i) {
    const auto status = state.motors[i].status;
    if (status == MotorStatus::kActive || status == MotorStatus::kEnabling)
      names += (names.empty() ? "" : ", ") + printable(welcome.motors[i].name.view());
  }
  return names;
}

std::string quoted(const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& line : lines) text += (text.empty() ? "`" : ", `") + line + "`";
  return text;
}

// By the file with which the robot started: no loop may act before the spin has shown the sign of its
// current.
Result<void> requireNoLoop(const Global& global, const link::Welcome& welcome, std::size_t place,
                           const std::string& name) {
  const auto config = runningConfig(global, welcome);
  const auto* motor = config ? motorAt(*config, place) : nullptr;
  if (motor == nullptr) {
    std::printf(
        "The file of the robot cannot be read here. See to it that on_timeout, on_disable and on_estop of %s "
        "are coast: a loop may drive it on while the sign of its current is not known.\n",
        name.c_str());
    return {};
  }
  const auto lines = untestedLoops(*motor);
  if (lines.empty()) return {};
  std::vector<std::string> meanwhile;
  meanwhile.reserve(lines.size());
  for (const auto& line : lines) meanwhile.push_back(line.substr(0, line.find(':')) + ": coast");
  return fail(name + " has " + quoted(lines) +
              ": a loop that would act when the spin is over, paused or stopped, and drive it on if the sign "
              "of its current is wrong, which the spin is to show: write " +
              quoted(meanwhile) + " for now, restart rc10d, and commission again");
}

class Commissioning {
 public:
  Commissioning(const Global& global, LinkClient& rc10d, const CommissionOptions& options, std::size_t motor,
                double current_a)
      : global_(global),
        rc10d_(rc10d),
        feed_(rc10d),
        options_(options),
        motor_(motor),
        current_a_(current_a) {}

  ExitCode run() {
    if (const auto there = feed_.awaitState(); !there) return complain(there.error(), ExitCode::kFailed);
    const auto on = motorsOn(rc10d_.welcome(), *feed_.state());
    if (!on.empty())
      return complain({"motors are enabled: " + on + ": `rc10ctl disable` first"}, ExitCode::kFailed);
    if (!handTurn()) return ExitCode::kFailed;
    return spin();
  }

 private:
  bool handTurn() {
    std::printf(
        "1. Make sure that nothing can be caught. Mark the output of %s.\n   Press Enter, then turn it by "
        "hand: one whole turn, "
        "counter-clockwise, seen from the output.\n",
        options_.motor.c_str());
    if (!waitLine(feed_) || !awaitPresent()) return gone();
    const link::State before = *feed_.state();
    (void)feed_.takeEvents();
    std::puts("   Turn it now; press Enter when the mark is back.");
    if (!waitLine(feed_) || !awaitPresent()) return gone();
    const auto turn = client::judgeHandTurn(before, *feed_.state(), motor_, losesAngle());
    const auto words = client::text(turn, rc10d_.welcome(), motor_);
    if (turn.outcome != client::HandTurn::Outcome::kGood) {
      (void)complain({words + next(turn.outcome)}, ExitCode::kFailed);
      return false;
    }
    std::printf("   %s\n", words.c_str());
    return true;
  }

  ExitCode spin() {
    std::printf("2. %s will get %s for %g s; above %g rpm it is let go. Type its name to spin it: ",
                options_.motor.c_str(), client::quantity(current_a_, 2, "A").c_str(),
                static_cast<double>(seconds(client::FirstSpin::kTime)), options_.over_speed_rpm);
    if (waitLine(feed_) != options_.motor) return complain({"nothing was enabled"}, ExitCode::kFailed);
    // From here on rc10d enables nothing else, until this one is disabled. However this program ends, rc10d
    // sees the end of `enabling` and disables it.
    auto enabling = connect(global_);
    if (!enabling) return complain(enabling.error(), ExitCode::kFailed);
    if (const auto enabled = askOver(*enabling, global_, Operation::kEnableAlone, {options_.motor},
                                     {{.name = link::kDisableAtEnd, .value = 1.0}});
        enabled != ExitCode::kOk)
      return enabled;
    awaitActive();
    client::FirstSpin seen(options_.over_speed_rpm);
    const auto outcome = drive(rc10d_, order(seen)).status;
    const auto disabled = askOver(*enabling, global_, Operation::kDisable, {options_.motor},
                                  {{.name = link::kAtEnd, .value = 1.0}});
    if (interrupted()) {
      const bool rests = disabled == ExitCode::kOk;
      return complain(
          {rests ? "stopped: it is disabled, and not commissioned"
                 : "stopped: not commissioned, and not disabled: `rc10ctl disable " + options_.motor + "`"},
          ExitCode::kFailed);
    }
    if (outcome != ExitCode::kOk) return outcome;
    const auto words = client::text(seen, options_.motor);
    if (seen.outcome() != client::FirstSpin::Outcome::kRight) return complain({words}, ExitCode::kFailed);
    std::printf("%s\n", words.c_str());
    return disabled;
  }

  bool losesAngle() {
    const auto events = feed_.takeEvents();
    return std::any_of(events.begin(), events.end(), [this](const link::Event& event) {
      return event.code == kReferenceLost && event.source.view() == options_.motor;
    });
  }

  static const char* next(client::HandTurn::Outcome outcome) {
    switch (outcome) {
      case client::HandTurn::Outcome::kAngleLost: return "";
      case client::HandTurn::Outcome::kNotTurned: return " Then commission again";
      default: return "; then restart rc10d and commission again";  // the file is wrong
    }
  }

  // False: none such comes within kShown, or rc10d has ended, or Ctrl-C.
  template <typename Such>
  bool awaitState(const Such& such) {
    const auto end = std::chrono::steady_clock::now() + kShown;
    while (feed_.pump() && !interrupted()) {
      const auto* state = feed_.state();
      if (state != nullptr && such(*state)) return true;
      const auto left = end - std::chrono::steady_clock::now();
      if (left <= Duration{0}) return false;
      waitReadable(rc10d_, left);
    }
    return false;
  }

  // The newest state may be of before the key that was pressed: it was sent up to a second ago.
  bool awaitPresent() {
    const auto pressed = std::chrono::steady_clock::now().time_since_epoch();
    return awaitState(
        [pressed](const link::State& state) { return std::chrono::microseconds{state.mono_us} > pressed; });
  }

  // The answer may have overtaken the state that shows it. If none does, drive() says what is there.
  void awaitActive() {
    (void)awaitState(
        [this](const link::State& state) { return state.motors[motor_].status == MotorStatus::kActive; });
  }

  Drive order(client::FirstSpin& seen) const {
    Drive order;
    order.then = Then::kCoast;  // Above its speed it must be let go, whatever its on_timeout is.
    order.setpoint.motor = options_.motor;
    order.setpoint.target.mode = ControlMode::kCurrent;
    order.setpoint.target.value = current_a_;
    order.motor = motor_;
    order.time = client::FirstSpin::kTime;
    order.steer = [this, &seen](link::Setpoint&, const link::State& state) -> std::optional<std::string> {
      const auto now = std::chrono::steady_clock::now();
      return seen.goesOn(state.motors[motor_], state.mono_us, now) ? std::nullopt
                                                                   : std::optional<std::string>{""};
    };
    order.hear = [&seen](const link::Event& event) {
      if (event.code == kReferenceLost) seen.loseAngle();
    };
    return order;
  }

  static bool gone() {
    (void)complain({"given up: nothing was enabled"}, ExitCode::kFailed);
    return false;
  }

  const Global& global_;
  LinkClient& rc10d_;
  Feed feed_;
  const CommissionOptions& options_;
  std::size_t motor_;
  double current_a_;
};

ExitCode commission(const Global& global, const CommissionOptions& options) {
  std::ios::sync_with_stdio(false);  // or in_avail() knows nothing
  const auto current_a = currentIn(options.limit);
  if (!current_a) return complain(current_a.error(), ExitCode::kUsage);
  auto rc10d = connect(global, link::kStates | link::kEvents);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  const auto motor = client::findMotor(rc10d->welcome(), options.motor);
  if (!motor) return complain(motor.error(), ExitCode::kFailed);
  if (const auto able = requireMode(rc10d->welcome().motors[*motor], ControlMode::kCurrent); !able)
    return complain({"commission spins it with a current: " + able.error().message}, ExitCode::kFailed);
  if (const auto why = client::whyTooRare(rc10d->welcome().state_hz); !why.empty())
    return complain({why}, ExitCode::kFailed);
  if (const auto coasts = requireNoLoop(global, rc10d->welcome(), *motor, options.motor); !coasts)
    return complain(coasts.error(), ExitCode::kFailed);
  return Commissioning(global, *rc10d, options, *motor, *current_a).run();
}

}  // namespace

void addCommission(CLI::App& app, Action& action) {
  const auto options = std::make_shared<CommissionOptions>();
  auto* verb = app.add_subcommand(
      "commission", "a motor's first time: turned by hand, then spun gently with all others at rest");
  verb->add_option("motor", options->motor, "name of the motor")->required()->type_name("MOTOR");
  verb->add_option("--limit", options->limit, "the current of the first spin")
      ->type_name("CURRENT")
      ->capture_default_str();
  verb->add_option("--over-speed", options->over_speed_rpm, "the spin ends above this")
      ->check(CLI::Range(1.0, 10000.0))
      ->type_name("RPM")
      ->capture_default_str();
  verb->callback([&action, options] {
    action = [options](const Global& global) { return commission(global, *options); };
  });
}

}  // namespace rc10::ctl
