#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "client/find_motor.hpp"
#include "client/jog_keys.hpp"
#include "client/quantity_text.hpp"
#include "drive.hpp"
#include "key_terminal.hpp"
#include "link/words.hpp"
#include "require_mode.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

struct JogOptions {
  std::string motor;
  double speed_rpm = 20.0;
  double most_rpm = 200.0;
  int dead_man_ms = 400;
  int priority = 0;
};

ExitCode jog(const Global& global, const JogOptions& options) {
  if (options.speed_rpm > options.most_rpm) {
    return complain({"--speed " + client::number(options.speed_rpm, 1) + " is above --max-speed " +
                     client::number(options.most_rpm, 1) + ": give a higher --max-speed, or a lower --speed"},
                    ExitCode::kUsage);
  }
  auto rc10d = connect(global, link::kStates | link::kEvents);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  const auto motor = client::findMotor(rc10d->welcome(), options.motor);
  if (!motor) return complain(motor.error(), ExitCode::kFailed);
  const auto velocity = ControlMode::kVelocity;
  if (const auto able = requireMode(rc10d->welcome().motors[*motor], velocity); !able)
    return complain(able.error(), ExitCode::kFailed);
  auto terminal = KeyTerminal::open();
  if (!terminal) return complain(terminal.error(), ExitCode::kUsage);

  client::JogKeys keys;
  client::JogSpeed speed(options.speed_rpm, options.most_rpm, std::chrono::milliseconds{options.dead_man_ms});
  Drive order;
  order.setpoint.motor = options.motor;
  order.setpoint.target.mode = velocity;
  order.motor = *motor;
  order.priority = options.priority;
  order.time = std::chrono::hours{24};
  order.steer = [&](link::Setpoint& setpoint, const link::State&) -> std::optional<std::string> {
    const auto now = std::chrono::steady_clock::now();
    bool closed = false;
    const auto typed = keys.take(terminal->typed(closed));
    closed = closed || std::find(typed.begin(), typed.end(), client::JogKey::kQuit) != typed.end();
    speed.press(typed, now);
    setpoint.target.value = speed.target(now);
    return closed ? std::optional<std::string>{""} : std::nullopt;
  };
  std::printf("hold right or left: turn at %g rpm; up, down: faster, slower; any other key: stand; q: end\n",
              speed.speed());
  return drive(*rc10d, order).status;
}

}  // namespace

void addJog(CLI::App& app, Action& action) {
  const auto options = std::make_shared<JogOptions>();
  auto* verb = app.add_subcommand("jog", "turns one motor with the arrow keys, as long as one is held");
  verb->add_option("motor", options->motor, "name of the motor")->required()->type_name("MOTOR");
  verb->add_option("--speed", options->speed_rpm, "at first")
      ->check(CLI::Range(0.5, 10000.0))
      ->type_name("RPM")
      ->capture_default_str();
  verb->add_option("--max-speed", options->most_rpm, "at most")
      ->check(CLI::Range(0.5, 10000.0))
      ->type_name("RPM")
      ->capture_default_str();
  verb->add_option("--dead-man-ms", options->dead_man_ms,
                   "so long after the last key the motor is told to stand")
      ->check(CLI::Range(100, 2000))
      ->type_name("MS")
      ->capture_default_str();
  verb->add_option("--priority", options->priority, "a higher one takes the motor over from a lower one");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return jog(global, *options); }; });
}

}  // namespace rc10::ctl
