#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "client/duration_text.hpp"
#include "client/motion/motion_plan.hpp"
#include "client/motion/motion_report.hpp"
#include "client/motion/motion_run.hpp"
#include "client/motion/motion_session.hpp"
#include "client/quantity_text.hpp"
#include "link/words.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

using std::chrono::steady_clock;

struct TestMotionOptions {
  std::string motor;
  std::string kind;
  double amplitude = 0.0;
  std::string mode = "velocity";
  double base = 0.0;
  std::optional<double> rate_per_s;
  std::optional<std::string> time;
  double from_hz = 1.0;
  double to_hz = 20.0;
  bool linear = false;
  double max_current_a = 0.0;
  std::optional<double> max_speed_rpm;
  std::optional<double> min_angle_deg;
  std::optional<double> max_angle_deg;
  std::string max_feedback_age = "200ms";
  bool stop_at_limits = false;
  int dead_man_ms = 200;
  int priority = 0;
  bool end_with_stdin = false;
  std::string csv;
  std::string bode;
};

Result<client::MotionPlan> planIn(const TestMotionOptions& options) {
  const auto mode = link::modeOf(options.mode).value_or(ControlMode::kVelocity);
  if (options.rate_per_s && options.kind != toString(client::ExcitationKind::kRamp))
    return fail("--rate is for a ramp, not for a " + options.kind + ": leave it out");
  if (mode != ControlMode::kVelocity && !options.max_speed_rpm)
    return fail("a test in mode " + options.mode + " needs --max-speed RPM: beyond it the motor is let go");
  const auto age = client::parseDuration(options.max_feedback_age);
  if (!age) return fail("--max-feedback-age " + options.max_feedback_age + ": give a time like 100ms");
  client::MotionPlan plan{.motor = options.motor,
                          .kind = client::excitationOf(options.kind).value_or(client::ExcitationKind::kStep),
                          .mode = mode,
                          .amplitude = options.amplitude,
                          .base = options.base,
                          .rate_per_s = options.rate_per_s,
                          .from_hz = options.from_hz,
                          .to_hz = options.to_hz,
                          .linear = options.linear,
                          .max_current_a = options.max_current_a,
                          .max_speed_rpm = options.max_speed_rpm,
                          .min_angle_deg = options.min_angle_deg,
                          .max_angle_deg = options.max_angle_deg,
                          .max_feedback_age_s = std::chrono::duration<double>(*age).count(),
                          .stop_at_limits = options.stop_at_limits,
                          .dead_man_ms = options.dead_man_ms};
  if (options.time) {
    const auto time = client::parseDuration(*options.time);
    if (!time) return fail("--for " + *options.time + ": give a time like 2s or 500ms");
    plan.time_s = std::chrono::duration<double>(*time).count();
  }
  return plan;
}

Result<client::MotionSettings> settingsIn(const TestMotionOptions& options) {
  const auto plan = planIn(options);
  if (!plan) return tl::unexpected(plan.error());
  return client::settingsOf(*plan, kClientName);
}

// Opened before anything moves; without a path there is none.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path) : path_(path) {
    if (!path.empty()) file_.open(path);
  }
  [[nodiscard]] bool isOpen() const { return path_.empty() || file_.is_open(); }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] bool write(const std::string& text) {
    return path_.empty() || static_cast<bool>((file_ << text).flush());
  }

 private:
  std::string path_;
  std::ofstream file_;
};

std::string title(const client::MotionSettings& settings) {
  const auto& excitation = settings.excitation;
  const char* unit = unitOf(settings.mode);
  std::string text = settings.motor + ": " + toString(settings.mode) + ", " + toString(excitation.kind) +
                     " of " + client::quantity(excitation.amplitude, 2, unit);
  if (excitation.base != 0.0) text += " around " + client::quantity(excitation.base, 2, unit);
  return text;
}

// The mistake, or nothing.
std::string verdict(const client::MotionRun& run, const char* doing) {
  const auto& abort = run.aborted();
  if (!abort) return {};
  const bool moved = !run.curve().empty();
  return "test of " + run.settings().motor + " ended by " + toString(abort->criterion) +
         (moved ? " after " + client::quantity(run.curve().back().time_s, 3, "s") : "") + ": " + abort->text +
         (moved ? "; " + run.settings().motor + " " + doing : "");
}

// One object, with what was measured until an abort too.
void printJson(const client::MotionReport& report, const client::MotionRun& run, const std::string& why) {
  auto json = client::jsonOf(report, run);
  if (!why.empty()) json["error"] = why;
  std::puts(client::lineOf(json).c_str());
}

// Reason to end it before its time; nullptr: none.
const char* interruption(const TestMotionOptions& options) {
  if (interrupted()) return "interrupted before its end";
  if (options.end_with_stdin && stdinEnded()) return "the program that runs it has ended (--end-with-stdin)";
  return nullptr;
}

ExitCode testMotion(const Global& global, const TestMotionOptions& options) {
  const auto settings = settingsIn(options);
  if (!settings) return complain(settings.error(), ExitCode::kUsage);
  auto rc10d = connect(global, link::kStates | link::kEvents);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  auto run = client::MotionRun::of(rc10d->welcome(), *settings);
  if (!run) return complain(run.error(), ExitCode::kFailed);
  OutputFile csv(options.csv);
  OutputFile bode(options.bode);
  for (const auto* file : {&csv, &bode}) {
    if (!file->isOpen()) return complain({file->path() + " cannot be written"}, ExitCode::kFailed);
  }
  client::MotionSession session(*rc10d, *run, options.priority);
  while (!run->over()) {
    session.receive();
    if (const auto* why = interruption(options)) run->end(client::Criterion::kInterrupted, why);
    session.send(steady_clock::now());
    waitReadable(*rc10d, run->due() - steady_clock::now());
  }
  const auto report = client::reportOf(*run);
  const auto why = verdict(*run, session.whatMotorDoes());
  if (global.json)
    printJson(report, *run, why);
  else
    std::printf("%s\n%s", title(*settings).c_str(), client::text(report, *run).c_str());
  if (!csv.write(client::curveCsv(run->curve())) || !bode.write(client::bodeCsv(report.response)))
    return complain({"the results could not be written: is the disk full?"}, ExitCode::kFailed);
  if (!why.empty()) {
    std::fflush(stdout);
    std::fprintf(stderr, "rc10ctl: %s\n", why.c_str());
    return ExitCode::kFailed;
  }
  if (!global.json) std::printf("%s %s\n", options.motor.c_str(), session.whatMotorDoes());
  return ExitCode::kOk;
}

void addShape(CLI::App& verb, TestMotionOptions& options) {
  verb.add_option("motor", options.motor, "name of the motor")->required()->type_name("MOTOR");
  verb.add_option("kind", options.kind, "step, ramp, sweep, multisine")
      ->required()
      ->check(CLI::IsMember({"step", "ramp", "sweep", "multisine"}))
      ->type_name("KIND");
  verb.add_option("amplitude", options.amplitude, "height, or peak of the sines, in the unit of the mode")
      ->required()
      ->type_name("AMPLITUDE");
  verb.add_option("--mode", options.mode, "velocity, current, or total_angle from where the motor stands")
      ->check(CLI::IsMember({"velocity", "total_angle", "current"}))
      ->type_name("MODE")
      ->capture_default_str();
  verb.add_option("--base", options.base, "the target before a step or ramp, and in the middle of sines")
      ->type_name("VALUE")
      ->capture_default_str();
  verb.add_option("--for", options.time,
                  "how long: 2s, 500ms; steps and ramps 1.5s, sines ten periods or 10s")
      ->type_name("TIME");
  verb.add_option("--rate", options.rate_per_s, "of a ramp, in a second")->type_name("VALUE");
  verb.add_option("--from", options.from_hz, "lowest frequency; a multisine has its multiples")
      ->type_name("HZ")
      ->capture_default_str();
  verb.add_option("--to", options.to_hz, "highest frequency, 50 at most")
      ->type_name("HZ")
      ->capture_default_str();
  verb.add_flag("--linear", options.linear, "a sweep by equal steps of frequency, not by equal ratios");
}

void addCriteria(CLI::App& verb, TestMotionOptions& options) {
  verb.add_option("--max-current", options.max_current_a, "above it the motor is let go")
      ->required()
      ->type_name("A");
  verb.add_option("--max-speed", options.max_speed_rpm,
                  "the same; mode velocity: by default its target and half of the amplitude more")
      ->type_name("RPM");
  verb.add_option(
          "--min-angle", options.min_angle_deg,
          "the same, from where the motor stands; total_angle: by default half of the amplitude beside "
          "the target, else none")
      ->type_name("DEG");
  verb.add_option("--max-angle", options.max_angle_deg, "the same")->type_name("DEG");
  verb.add_option("--max-feedback-age", options.max_feedback_age, "the same, for its feedback as it is here")
      ->type_name("TIME")
      ->capture_default_str();
  verb.add_flag("--stop-at-limits", options.stop_at_limits, "lets go too when a limit of the motor acts");
  verb.add_option("--dead-man-ms", options.dead_man_ms,
                  "so long after its last word, when it has died or had no processor")
      ->check(CLI::Range(20, 1000))
      ->type_name("MS")
      ->capture_default_str();
}

}  // namespace

void addTestMotion(CLI::App& app, Action& action) {
  const auto options = std::make_shared<TestMotionOptions>();
  auto* verb = app.add_subcommand(
      "test-motion", "moves one motor by a step, ramp or sines within bounds, and judges how it follows");
  addShape(*verb, *options);
  addCriteria(*verb, *options);
  verb->add_option("--priority", options->priority, "a higher one takes the motor over from a lower one");
  verb->add_flag("--end-with-stdin", options->end_with_stdin,
                 "ends as by Ctrl-C when stdin is closed: with the program that holds its other end");
  verb->add_option("--csv", options->csv, "writes each tick")->type_name("FILE");
  verb->add_option("--bode", options->bode, "writes gain, phase and coherence")->type_name("FILE");
  verb->callback([&action, options] {
    action = [options](const Global& global) { return testMotion(global, *options); };
  });
}

}  // namespace rc10::ctl
