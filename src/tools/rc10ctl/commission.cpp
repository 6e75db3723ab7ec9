#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "ask.hpp"
#include "client/find_motor.hpp"
#include "client/hand_turn.hpp"
#include "client/quantity_text.hpp"
#include "client/text_table.hpp"
#include "drive.hpp"
#include "feed.hpp"
#include "link/words.hpp"
#include "require_mode.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

constexpr double kMostCurrentA = 20.0;
constexpr Duration kSpinTime = std::chrono::seconds{1};
/// Less is noise, play in the gear, or the shaft that was let go.
constexpr double kLeastTurnDeg = 5.0;

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
    // What was typed ahead is in the stream already.
    if (std::cin.rdbuf()->in_avail() > 0 || ::poll(&entry, 1, 50) > 0) {
      std::string line;
      return std::getline(std::cin, line) && feed.pump() ? std::optional{line} : std::nullopt;
    }
    if (!feed.pump()) return std::nullopt;
  }
  return std::nullopt;
}

// Empty, or the names of motors that may move beside this one.
std::string othersActive(const link::Welcome& welcome, const link::State& state, std::size_t motor) {
  std::string names;
  for (std::size_t i = 0; i < std::min<std::size_t>(state.motor_count, welcome.motor_count); ++i) {
    const bool rests =
        state.motors[i].status != link::kMotorActive && state.motors[i].status != link::kMotorEnabling;
    if (i != motor && !rests)
      names += (names.empty() ? "" : ", ") + client::printable(welcome.motors[i].name.view());
  }
  return names;
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
    const auto active = othersActive(rc10d_.welcome(), *feed_.state(), link::kMaxMotors);
    if (!active.empty())
      return complain({"motors are enabled: " + active + ": `rc10ctl disable` first"}, ExitCode::kFailed);
    if (!handTurn()) return ExitCode::kFailed;
    return spin();
  }

 private:
  struct Spin {
    double turned_deg = 0.0;
    bool fast = false;  ///< It reached the over-speed, forwards.
  };

  bool handTurn() {
    std::printf(
        "1. Make sure that nothing can be caught. Mark the output of %s.\n   Press Enter, then turn it by "
        "hand: one whole turn, "
        "counter-clockwise, seen from the output.\n",
        options_.motor.c_str());
    if (!waitLine(feed_)) return gone();
    const link::State before = *feed_.state();
    std::puts("   Turn it now; press Enter when the mark is back.");
    if (!waitLine(feed_)) return gone();
    const auto turn = client::judgeHandTurn(before, *feed_.state(), motor_);
    const auto words = client::text(turn, rc10d_.welcome(), motor_);
    if (turn.outcome != client::HandTurn::Outcome::kGood) {
      (void)complain({words + "; then restart rc10d and commission again"}, ExitCode::kFailed);
      return false;
    }
    std::printf("   %s\n", words.c_str());
    return true;
  }

  ExitCode spin() {
    std::printf("2. %s will get %s for %g s; above %g rpm it is let go. Type its name to spin it: ",
                options_.motor.c_str(), client::quantity(current_a_, 2, "A").c_str(),
                static_cast<double>(seconds(kSpinTime)), options_.over_speed_rpm);
    if (waitLine(feed_) != options_.motor) return complain({"nothing was enabled"}, ExitCode::kFailed);
    if (const auto enabled = ask(global_, "enable", {options_.motor}); enabled != ExitCode::kOk)
      return enabled;
    Spin seen;
    const auto outcome = drive(rc10d_, order(seen));
    const double turned_deg = seen.turned_deg;
    const auto disabled = ask(global_, "disable", {options_.motor});
    if (outcome != ExitCode::kOk) return outcome;
    if (interrupted()) return complain({"stopped: it is disabled, and not commissioned"}, ExitCode::kFailed);
    // Written so that an unknown angle is no success.
    if (!seen.fast && !(turned_deg >= kLeastTurnDeg)) {
      return complain(
          {"it turned by " + client::number(turned_deg, 1) + " deg with a positive current: " +
           (turned_deg <= -kLeastTurnDeg
                ? "the drive's current has the other sign than its encoder: see its page in docs/motors"
                : "it did not move: is it blocked, or the current too small (--limit)?")},
          ExitCode::kFailed);
    }
    std::printf("%s turned by %s deg the right way: it is ready\n", options_.motor.c_str(),
                client::number(turned_deg, 1).c_str());
    return disabled;
  }

  Drive order(Spin& seen) const {
    Drive order;
    order.setpoint.motor = options_.motor;
    order.setpoint.mode = link::modeOf("current").value_or(link::kModeCoast);
    order.setpoint.value = current_a_;
    order.motor = motor_;
    order.time = kSpinTime;
    order.steer = [this, start_deg = std::optional<double>{}, &seen](
                      link::Setpoint&, const link::State& state) mutable -> std::optional<std::string> {
      const auto& motor = state.motors[motor_];
      // Where it stands when the current begins: a shaft that was let go has turned before.
      if (!start_deg) start_deg = motor.total_angle_deg;
      seen.turned_deg = motor.total_angle_deg - *start_deg;
      const auto active = othersActive(rc10d_.welcome(), state, motor_);
      if (!active.empty())
        return "another program has enabled " + active + ": commission with nothing else running";
      if (!std::isfinite(motor.velocity_rpm)) return "its drive reports no speed: nothing can be judged";
      const auto velocity_rpm = static_cast<double>(motor.velocity_rpm);
      if (std::abs(velocity_rpm) <= options_.over_speed_rpm) return std::nullopt;
      // Fast enough is a success: it turns.
      seen.fast = velocity_rpm > 0.0 && seen.turned_deg > 0.0;
      return seen.fast ? "" : "too fast, and the wrong way: " + client::quantity(velocity_rpm, 0, "rpm");
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
  if (const auto able =
          requireMode(rc10d->welcome().motors[*motor], link::modeOf("current").value_or(link::kModeCoast));
      !able)
    return complain(able.error(), ExitCode::kFailed);
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
