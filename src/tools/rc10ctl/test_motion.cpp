#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/duration_text.hpp"
#include "client/motion/motion_report.hpp"
#include "client/motion/motion_run.hpp"
#include "client/quantity_text.hpp"
#include "client/request_call.hpp"
#include "client/state_text.hpp"
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
  std::string csv;
  std::string bode;
};

// Share of the amplitude beside the target that the angle and the speed of a sound loop may take.
constexpr double kRoom = 0.5;

// Ten periods give a mean of nine segments.
double defaultTimeS(const client::ExcitationSettings& excitation) {
  using Kind = client::ExcitationKind;
  const bool sines = excitation.kind == Kind::kSweep || excitation.kind == Kind::kMultisine;
  return sines ? std::max(10.0, 10.0 / excitation.from_hz) : 1.5;
}

Result<client::ExcitationSettings> excitationIn(const TestMotionOptions& options) {
  client::ExcitationSettings excitation{
      .kind = client::excitationOf(options.kind).value_or(client::ExcitationKind::kStep),
      .base = options.base,
      .amplitude = options.amplitude,
      .rate_per_s = options.rate_per_s.value_or(0.0),
      .from_hz = options.from_hz,
      .to_hz = options.to_hz,
      .linear = options.linear};
  if (options.rate_per_s && excitation.kind != client::ExcitationKind::kRamp)
    return fail("--rate is for a ramp, not for a " + options.kind + ": leave it out");
  excitation.time_s = defaultTimeS(excitation);
  if (options.time) {
    const auto time = client::parseDuration(*options.time);
    if (!time) return fail("--for " + *options.time + ": give a time like 2s or 500ms");
    excitation.time_s = std::chrono::duration<double>(*time).count();
  }
  return excitation;
}

Result<client::AbortCriteria> criteriaIn(const TestMotionOptions& options, ControlMode mode,
                                         const client::Excitation& excitation) {
  const auto age = client::parseDuration(options.max_feedback_age);
  if (!age) return fail("--max-feedback-age " + options.max_feedback_age + ": give a time like 100ms");
  client::AbortCriteria criteria;
  criteria.current_max_a = options.max_current_a;
  criteria.feedback_age_max_us = std::chrono::duration<double, std::micro>(*age).count();
  criteria.limits_abort = options.stop_at_limits;
  const double room = kRoom * std::abs(options.amplitude);
  if (mode == ControlMode::kVelocity) {
    criteria.velocity_max_rpm = std::max(-excitation.lowest(), excitation.highest()) + room;
  } else if (!options.max_speed_rpm) {
    return fail("a test in mode " + options.mode + " needs --max-speed RPM: beyond it the motor is let go");
  }
  if (mode == ControlMode::kTotalAngle) {
    criteria.angle_min_deg = excitation.lowest() - room;
    criteria.angle_max_deg = excitation.highest() + room;
  }
  criteria.velocity_max_rpm = options.max_speed_rpm.value_or(criteria.velocity_max_rpm);
  criteria.angle_min_deg = options.min_angle_deg.value_or(criteria.angle_min_deg);
  criteria.angle_max_deg = options.max_angle_deg.value_or(criteria.angle_max_deg);
  return criteria;
}

Result<client::MotionSettings> settingsIn(const TestMotionOptions& options) {
  const auto mode = link::modeOf(options.mode).value_or(ControlMode::kVelocity);
  const auto excitation = excitationIn(options);
  if (!excitation) return tl::unexpected(excitation.error());
  const auto shape = client::Excitation::of(*excitation);
  if (!shape) return tl::unexpected(shape.error());
  const auto criteria = criteriaIn(options, mode, *shape);
  if (!criteria) return tl::unexpected(criteria.error());
  if (const auto fit = client::admits(*criteria, *shape, mode); !fit) return tl::unexpected(fit.error());
  return client::MotionSettings{.client = kClientName,
                                .motor = options.motor,
                                .mode = mode,
                                .excitation = *excitation,
                                .criteria = *criteria,
                                .validity_ms = options.dead_man_ms};
}

// Between the run and the connection.
class MotionSession {
 public:
  MotionSession(LinkClient& rc10d, client::MotionRun& run, std::int32_t priority)
      : rc10d_(rc10d), run_(run), buffer_(link::kMaxMessageSize) {
    command_.client = run.settings().client;
    command_.session = randomSession();
    command_.priority = priority;
    command_.setpoint_count = 1;
    command_.setpoints[0].motor = run.settings().motor;
  }

  void run() {
    auto choice = run_.choice();
    (void)rc10d_.send(choice);
    while (!run_.over()) {
      if (!receive()) run_.end(client::Criterion::kConnection, rc10dEnded().message);
      if (interrupted()) run_.end(client::Criterion::kInterrupted, "interrupted before its end");
      if (const auto order = run_.order(steady_clock::now())) send(*order);
      waitReadable(rc10d_, run_.due() - steady_clock::now());
    }
  }

  /// The motor's action by the newest state.
  [[nodiscard]] const char* whatMotorDoes() const noexcept {
    return held_ ? "is let go as soon as rc10d goes on" : client::whatActs(acting_);
  }

 private:
  // False: rc10d has ended.
  [[nodiscard]] bool receive() {
    for (;;) {
      const auto received = rc10d_.receive(buffer_);
      if (received.status == LinkClient::ReceiveStatus::kClosed) return false;
      if (received.status == LinkClient::ReceiveStatus::kNothing) return true;
      take(received.datagram);
    }
  }

  void take(std::span<const std::byte> datagram) {
    if (link::open(datagram, trace_)) {
      run_.take(trace_);
    } else if (link::open(datagram, state_)) {
      const bool known = run_.motor() < state_.motor_count;
      acting_ = known ? state_.motors[run_.motor()].acting : Acting::kNothing;
      held_ = known && state_.motors[run_.motor()].owner.view() == command_.client.view();
      run_.take(state_);
    } else if (link::Event event; link::open(datagram, event)) {
      run_.take(event);
    }
  }

  // One that is lost is followed by another, or lapses.
  void send(const client::MotionRun::Order& order) {
    command_.setpoints[0].target = order.target;
    command_.validity_ms = order.validity_ms;
    command_.received_ns = 0;  // the present time
    ++command_.seq;
    (void)rc10d_.send(command_);
  }

  LinkClient& rc10d_;
  client::MotionRun& run_;
  std::vector<std::byte> buffer_;
  link::Command command_;
  link::Trace trace_;
  link::State state_;
  Acting acting_{};
  bool held_ = false;  // its target is in force still
};

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
  MotionSession session(*rc10d, *run, options.priority);
  session.run();
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
  verb->add_option("--csv", options->csv, "writes each tick")->type_name("FILE");
  verb->add_option("--bode", options->bode, "writes gain, phase and coherence")->type_name("FILE");
  verb->callback([&action, options] {
    action = [options](const Global& global) { return testMotion(global, *options); };
  });
}

}  // namespace rc10::ctl
