#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/units.hpp"
#include "ask.hpp"
#include "client/find_motor.hpp"
#include "client/json_line.hpp"
#include "client/quantity_text.hpp"
#include "feed.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

struct HandOptions {
  std::string motor;
  std::optional<double> by_deg;
  std::optional<double> to_deg;
  double speed_rpm = 30.0;
  double torque_nm = 5.0;
  double hold_s = 0.0;
};

// The hand takes so long more, to reach its speed and to come to rest from it.
constexpr double kRampS = 0.1;
// After its way it brings the shaft to rest; before this is over it is read,
constexpr double kSettledS = 0.2;
// and after this it has let go.
constexpr double kLetGoS = 0.2;
// A shaft that comes late is led on until it is at rest, for so long at most.
constexpr double kLedOnS = 5.0;
constexpr double kAtRestRpm = 0.5;

[[nodiscard]] link::NamedValue value(std::string_view name, double number) {
  return {.name = name, .value = number};
}

// States until then; false: rc10d has ended, or Ctrl-C.
[[nodiscard]] bool watch(LinkClient& rc10d, Feed& feed, double time_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_s);
  while (feed.pump() && !interrupted()) {
    const auto left = end - std::chrono::steady_clock::now();
    if (left.count() <= 0) return true;
    waitReadable(rc10d, std::chrono::duration_cast<Duration>(left));
  }
  return false;
}

ExitCode hand(const Global& global, const HandOptions& options) {
  if (options.by_deg.has_value() == options.to_deg.has_value())
    return complain({"hand: say how far: --by DEG, or --to DEG"}, ExitCode::kUsage);
  auto rc10d = connect(global, link::kStates);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  const auto motor = client::findMotor(rc10d->welcome(), options.motor);
  if (!motor) return complain(motor.error(), ExitCode::kFailed);
  Feed feed(*rc10d);
  if (const auto heard = feed.awaitState(); !heard) return complain(heard.error(), ExitCode::kFailed);
  const double before_deg = feed.state()->motors[*motor].total_angle_deg;
  if (options.to_deg && !std::isfinite(before_deg)) {
    return complain({"hand: the angle of '" + options.motor +
                     "' is not known: turn it by an angle (--by), or wait until it is heard"},
                    ExitCode::kFailed);
  }
  const double by_deg = options.by_deg ? *options.by_deg : *options.to_deg - before_deg;
  const std::vector<link::NamedValue> values{value("by_deg", by_deg), value("speed_rpm", options.speed_rpm),
                                             value("torque_nm", options.torque_nm),
                                             value("hold_s", options.hold_s)};
  if (const auto asked = ask(global, Operation::kHand, {options.motor}, values); asked != ExitCode::kOk)
    return asked;
  const double way_s = std::abs(by_deg) / (options.speed_rpm * kDegPerSPerRpm);
  bool there = watch(*rc10d, feed, way_s + kRampS + options.hold_s + kSettledS);
  for (double late_s = 0.0; there && late_s < kLedOnS; late_s += kSettledS) {
    if (std::abs(static_cast<double>(feed.state()->motors[*motor].velocity_rpm)) <= kAtRestRpm) break;
    there = watch(*rc10d, feed, kSettledS);
  }
  const double after_deg = feed.state()->motors[*motor].total_angle_deg;
  there = there && watch(*rc10d, feed, kLetGoS);
  if (!there) return interrupted() ? ExitCode::kFailed : complain(rc10dEnded(), ExitCode::kFailed);
  if (global.json) {
    std::puts(client::lineOf({{"motor", options.motor}, {"before_deg", before_deg}, {"after_deg", after_deg}})
                  .c_str());
    return ExitCode::kOk;
  }
  std::printf("%s: %s -> %s\n", options.motor.c_str(), client::quantity(before_deg, 1, "deg").c_str(),
              client::quantity(after_deg, 1, "deg").c_str());
  return ExitCode::kOk;
}

}  // namespace

void addHand(CLI::App& app, Action& action) {
  const auto options = std::make_shared<HandOptions>();
  auto* verb = app.add_subcommand(
      "hand", "turns the shaft of a simulated motor as a hand would, and waits until it has let go");
  verb->add_option("motor", options->motor, "name of the motor; its bus has `type: sim`")
      ->required()
      ->type_name("MOTOR");
  verb->add_option("--by", options->by_deg, "so far from where it is")->type_name("DEG");
  verb->add_option("--to", options->to_deg, "until the motor reports this angle")->type_name("DEG");
  verb->add_option("--rpm", options->speed_rpm, "so fast")
      ->check(CLI::Range(0.1, 600.0))
      ->type_name("RPM")
      ->capture_default_str();
  verb->add_option("--torque", options->torque_nm, "it pulls no harder: a motor that holds may win")
      ->check(CLI::Range(0.01, 1000.0))
      ->type_name("NM")
      ->capture_default_str();
  verb->add_option("--hold", options->hold_s, "it stays at its end so long")
      ->check(CLI::Range(0.0, 60.0))
      ->type_name("S")
      ->capture_default_str();
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return hand(global, *options); }; });
}

}  // namespace rc10::ctl
