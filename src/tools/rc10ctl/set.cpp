#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/nearest.hpp"
#include "app/printable.hpp"
#include "app/target.hpp"
#include "ask.hpp"
#include "client/duration_text.hpp"
#include "client/find_motor.hpp"
#include "drive.hpp"
#include "link/at_end.hpp"
#include "link/words.hpp"
#include "motor/solo_motor.hpp"
#include "running_config.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

// For a word that is one of a few.
[[nodiscard]] CLI::Validator oneOf(const std::vector<std::string>& words) {
  std::string list;
  for (const auto& word : words) list += (list.empty() ? "" : ",") + word;
  return CLI::Validator(
      [words, list](std::string& word) {
        if (std::find(words.begin(), words.end(), word) != words.end()) return std::string{};
        return "'" + printable(word) + "' is not one of " + list +
               didYouMean(word, {words.begin(), words.end()});
      },
      "{" + list + "}");
}

struct SetOptions {
  std::string motor;
  std::string mode;
  std::optional<double> value;
  std::string time = "2s";
  std::string then = "timeout";
  int priority = 0;
  float velocity_ff_rpm = 0.0F;
  float torque_ff_nm = 0.0F;
  float stiffness_nm_per_rad = 0.0F;
  float damping_nms_per_rad = 0.0F;
};

constexpr std::uint32_t kAllModes = (1U << kControlModeCount) - 1U;

std::vector<std::string_view> modeNames() {
  std::vector<std::string_view> names;
  for (unsigned mode = 0; mode < kControlModeCount; ++mode)
    names.emplace_back(toString(static_cast<ControlMode>(mode)));
  return names;
}

// Parses the options; needs no robot.
Result<Drive> driveFrom(const SetOptions& options) {
  const auto mode = link::modeOf(options.mode);
  if (!mode)
    return fail("'" + options.mode + "' is not a mode: use one of " + link::modeWords(kAllModes) +
                didYouMean(options.mode, modeNames()));
  const bool needs_value = *mode != ControlMode::kCoast && *mode != ControlMode::kBrake;
  if (needs_value && !options.value) {
    return fail("mode " + options.mode + " needs a value: `rc10ctl set " + options.motor + " " +
                options.mode + " 10`");
  }
  if (!std::isfinite(options.value.value_or(0.0)))
    return fail("a target is a finite number, such as `rc10ctl set " + options.motor + " " + options.mode +
                " 10`");
  const TargetFields used = fieldsOf(*mode);
  if (!used.velocity_ff && options.velocity_ff_rpm != 0.0F)
    return fail("--velocity-ff is for angle, total_angle and impedance, not for " + options.mode +
                ": leave it out");
  if (!used.torque_ff && options.torque_ff_nm != 0.0F)
    return fail("--torque-ff is not for " + options.mode + ": leave it out");
  if (!used.spring && (options.stiffness_nm_per_rad != 0.0F || options.damping_nms_per_rad != 0.0F))
    return fail("--stiffness and --damping are for impedance, not for " + options.mode + ": leave them out");
  if (used.spring && options.stiffness_nm_per_rad == 0.0F && options.damping_nms_per_rad == 0.0F &&
      options.torque_ff_nm == 0.0F) {
    return fail("impedance without --stiffness, --damping or --torque-ff has no torque: `rc10ctl set " +
                options.motor + " impedance 10 --stiffness 2 --damping 0.1`");
  }
  const auto time = client::parseDuration(options.time);
  if (!time) return fail("--for " + options.time + ": give a time like 2s, 500ms or 1min, at most a day");
  if (options.motor.size() >= sizeof(link::Name))
    return fail("there is no motor '" + options.motor + "': see `rc10ctl list`");
  Drive order;
  order.setpoint.motor = options.motor;
  order.setpoint.target.mode = *mode;
  order.setpoint.target.value = options.value.value_or(0.0);
  order.setpoint.target.velocity_ff_rpm = options.velocity_ff_rpm;
  order.setpoint.target.torque_ff_nm = options.torque_ff_nm;
  order.setpoint.target.stiffness_nm_per_rad = options.stiffness_nm_per_rad;
  order.setpoint.target.damping_nms_per_rad = options.damping_nms_per_rad;
  order.priority = options.priority;
  order.time = *time;
  order.then = options.then == "coast"     ? Then::kCoast
               : options.then == "disable" ? Then::kDisable
                                           : Then::kTimeout;
  return order;
}

// Finds the motor; empty, or why this robot cannot do it.
std::string whyDriveUnfit(Drive& order, const link::Welcome& welcome) {
  const auto name = order.setpoint.motor.view();
  const auto found = client::findMotor(welcome, name);
  if (!found) return found.error().message;
  order.motor = *found;
  const auto mode = order.setpoint.target.mode;
  const auto modes = welcome.motors[*found].modes;
  if (mode != ControlMode::kCoast && (modes & (1U << static_cast<unsigned>(mode))) == 0) {
    return "motor '" + std::string(name) + "' has no mode " + toString(mode) + "; it has " +
           link::modeWords(modes);
  }
  return {};
}

// A current in milliamperes would act as the whole limit at once; empty, or the limit that it passes.
std::string whyTooMuch(const MotorConfig& motor, const MotorTraits& traits, double current_a) {
  if (traits.effort != CommandUnit::kAmpere) return {};
  const float limit_a = effortLimitOf(motor.settings, traits.effort_full_scale);
  if (!(limit_a > 0.0F) || std::abs(current_a) <= static_cast<double>(limit_a)) return {};
  std::ostringstream text;
  text << current_a << " A is beyond the current_limit_a of " << motor.name() << ", " << limit_a
       << " A: give amperes, " << limit_a << " at most";
  return text.str();
}

// rc10d would refuse each command; empty, or the gains that the drive takes.
std::string whyTooStiff(const MotorConfig& motor, const MotorTraits& traits, const Target& target) {
  const auto range = springRangeOf(motor.settings, traits);
  if (range.has(target.stiffness_nm_per_rad, target.damping_nms_per_rad)) return {};
  std::ostringstream text;
  text << "the drive of " << motor.name() << " takes --stiffness 0 to " << range.stiffness_nm_per_rad
       << " (Nm/rad) and --damping 0 to " << range.damping_nms_per_rad << " (Nms/rad)";
  return text.str();
}

// By the file with which the robot started; empty, or the range that the target leaves.
std::string whyOutOfRange(const Global& global, const Drive& order, const link::Welcome& welcome) {
  const Target& target = order.setpoint.target;
  if (target.mode != ControlMode::kCurrent && target.mode != ControlMode::kImpedance) return {};
  const auto config = runningConfig(global, welcome);
  const auto* motor = config ? motorAt(*config, order.motor) : nullptr;
  if (motor == nullptr) return {};
  const MotorTraits traits = motor->traits();
  return target.mode == ControlMode::kCurrent ? whyTooMuch(*motor, traits, target.value)
                                              : whyTooStiff(*motor, traits, target);
}

ExitCode set(const Global& global, const SetOptions& options) {
  auto order = driveFrom(options);
  if (!order) return complain(order.error(), ExitCode::kUsage);
  auto rc10d = connect(global, link::kStates | link::kEvents);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  if (const auto why = whyDriveUnfit(*order, rc10d->welcome()); !why.empty())
    return complain({why}, ExitCode::kFailed);
  if (const auto why = whyOutOfRange(global, *order, rc10d->welcome()); !why.empty())
    return complain({why}, ExitCode::kFailed);
  const auto done = drive(*rc10d, *order);
  // A motor that obeys somebody else is not ours to disable.
  if (order->then != Then::kDisable || !done.ours) return done.status;
  // It comes with our end: what an e-stop holds meanwhile stays held.
  const auto disabled =
      ask(global, Operation::kDisable, {options.motor}, {{.name = link::kAtEnd, .value = 1.0}});
  return done.status == ExitCode::kOk ? disabled : done.status;
}

}  // namespace

void addSet(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SetOptions>();
  auto* verb = app.add_subcommand("set", "gives one motor a target for a while; then its on_timeout acts");
  verb->add_option("motor", options->motor, "name of the motor")->required()->type_name("MOTOR");
  verb->add_option("mode", options->mode, link::modeWords(kAllModes))->required()->type_name("MODE");
  verb->add_option("value", options->value, "in the unit of the mode: A, rpm, deg, V; duty -1 to 1")
      ->type_name("VALUE");
  verb->add_option("--for", options->time, "how long: 2s, 500ms, 1min")
      ->type_name("TIME")
      ->capture_default_str();
  verb->add_option("--then", options->then, "its end: timeout (its on_timeout), coast or disable")
      ->check(oneOf({"timeout", "coast", "disable"}))
      ->type_name("END")
      ->capture_default_str();
  verb->add_option("--priority", options->priority, "a higher one takes the motor over from a lower one");
  verb->add_option("--velocity-ff", options->velocity_ff_rpm, "added to the angle loop's output")
      ->type_name("RPM");
  verb->add_option("--torque-ff", options->torque_ff_nm, "added after the loops, at the output shaft")
      ->type_name("NM");
  verb->add_option("--stiffness", options->stiffness_nm_per_rad, "impedance only")->type_name("NM/RAD");
  verb->add_option("--damping", options->damping_nms_per_rad, "impedance only")->type_name("NMS/RAD");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return set(global, *options); }; });
}

}  // namespace rc10::ctl
