#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/event_code.hpp"
#include "app/nearest.hpp"
#include "app/printable.hpp"
#include "client/command_stream.hpp"
#include "client/duration_text.hpp"
#include "client/module_text.hpp"
#include "client/obstacle.hpp"
#include "client/request_call.hpp"
#include "config/module_motors.hpp"
#include "feed.hpp"
#include "named_value.hpp"
#include "running_config.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

using std::chrono::steady_clock;

void printModules(const Global& global, const std::vector<client::ModuleView>& modules) {
  std::fputs((global.json ? client::modulesJson(modules) + "\n" : client::modulesText(modules)).c_str(),
             stdout);
}

ExitCode modules(const Global& global) {
  auto rc10d = connect(global, link::kModules);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  Feed feed{*rc10d};
  if (const auto there = feed.awaitModules(); !there) return complain(there.error(), ExitCode::kFailed);
  printModules(global, feed.modules());
  return ExitCode::kOk;
}

struct SignalOptions {
  std::string module;
  std::vector<std::string> values;
  std::string time = "2s";
  int priority = 0;
};

Result<link::Signals> signalsFrom(const SignalOptions& options) {
  link::Signals message;
  message.client = kClientName;
  message.session = randomSession();
  message.priority = options.priority;
  message.validity_ms = kValidityMs;
  message.module = options.module;
  if (options.values.size() > link::kMaxSignals)
    return fail("more than " + std::to_string(link::kMaxSignals) +
                " values: no module has so many inputs; `rc10ctl modules` names them");
  for (const auto& text : options.values) {
    auto value = namedValue(text, "vx_m_s=0.5");
    if (!value) return tl::unexpected(value.error());
    message.values[message.value_count++] = *value;
  }
  return message;
}

std::vector<std::string_view> viewsOf(std::span<const link::Name> names) {
  std::vector<std::string_view> views;
  for (const auto& name : names) views.push_back(name.view());
  return views;
}

/// The motors that the module drives, by the file with which the robot started; nothing if that cannot be
/// read.
std::optional<std::vector<std::size_t>> motorsOf(const Global& global, const link::Welcome& welcome,
                                                 std::string_view module) {
  const auto config = runningConfig(global, welcome);
  if (!config) return std::nullopt;
  for (const auto& each : config->modules) {
    if (each.settings.name != module) continue;
    auto motors = motorsNamedBy(each);
    motors.erase(std::remove_if(motors.begin(), motors.end(),
                                [&](std::size_t motor) { return motor >= welcome.motor_count; }),
                 motors.end());
    return motors;
  }
  return std::nullopt;
}

std::vector<std::size_t> allMotors(const link::Welcome& welcome) {
  std::vector<std::size_t> motors(std::min<std::size_t>(welcome.motor_count, link::kMaxMotors));
  std::iota(motors.begin(), motors.end(), std::size_t{0});
  return motors;
}

/// Reason why the module moves nothing though it takes its inputs, and the remedy; empty if it can.
std::string whyAtRest(const client::ModuleView& module, const std::vector<std::size_t>& motors,
                      const link::Welcome& welcome, const link::State* state) {
  if (state == nullptr) return {};
  std::string ready;
  std::string other;
  const bool runs = state->robot_state == RobotStatus::kRun;
  for (const auto motor : motors) {
    const auto& reading = state->motors[motor];
    const std::string name = printable(welcome.motors[motor].name.view());
    const auto why = client::obstacle(*state, name, reading);
    if (why.empty()) continue;
    const bool faulty = reading.status == MotorStatus::kOffline || reading.status == MotorStatus::kFault;
    if (runs ? reading.status == MotorStatus::kReady : !faulty)
      ready += " " + name;
    else if (other.empty())
      other = why;
  }
  if (ready.empty() && other.empty()) return {};
  const std::string what =
      "module '" + printable(module.name.view()) + "' takes its inputs and moves nothing: ";
  if (!runs)
    return what + "the robot is in " + toString(state->robot_state) +
           ": `rc10ctl clear`, then `rc10ctl enable" + ready + "`";
  return what + (other.empty() ? "not enabled: `rc10ctl enable" + ready + "`" : other);
}

/// Empty, or why this robot cannot take it.
std::string whySignalsUnfit(const link::Signals& message, const std::vector<client::ModuleView>& modules) {
  std::string known;
  for (const auto& module : modules) {
    known += (known.empty() ? "" : ", ") + printable(module.name.view());
    if (module.name.view() != message.module.view()) continue;
    const auto inputs = std::span{module.info.names}.first(module.info.input_count);
    std::string names;
    for (const auto& input : inputs) names += (names.empty() ? "" : ", ") + printable(input.view());
    for (const auto& value : std::span{message.values}.first(message.value_count)) {
      const auto found = std::find_if(inputs.begin(), inputs.end(),
                                      [&](const auto& input) { return input.view() == value.name.view(); });
      if (found == inputs.end())
        return "module '" + std::string(message.module.view()) + "' has no input '" +
               std::string(value.name.view()) + "'; it has " + (names.empty() ? "none" : names) +
               didYouMean(value.name.view(), viewsOf(inputs));
    }
    return {};
  }
  std::vector<std::string_view> names;
  names.reserve(modules.size());
  for (const auto& module : modules) names.push_back(module.name.view());
  return "there is no module '" + std::string(message.module.view()) + "'; there are: " + known +
         printable(didYouMean(message.module.view(), names));
}

/// Gives a module its inputs for a while.
class Signalling {
 public:
  Signalling(const Global& global, LinkClient& rc10d, Feed& feed, link::Signals& message)
      : rc10d_(rc10d),
        feed_(feed),
        message_(message),
        module_(*std::find_if(feed.modules().begin(), feed.modules().end(),
                              [&](const auto& each) { return each.name.view() == message.module.view(); })),
        name_(printable(module_.name.view())),
        motors_(motorsOf(global, rc10d.welcome(), module_.name.view())),
        watched_(motors_ ? *motors_ : allMotors(rc10d.welcome())),
        stream_(namesOf(watched_), kSendPeriod) {}

  ExitCode run(const Global& global, Duration time) {
    if (const auto there = feed_.awaitState(); !there) return complain(there.error(), ExitCode::kFailed);
    runs_ = feed_.state()->robot_state == RobotStatus::kRun;
    // It would move them as soon as somebody clears and enables.
    if (const auto why = runs_ ? std::string{} : atRest(); !why.empty())
      return complain({why}, ExitCode::kFailed);
    for (const auto motor : watched_) {
      if (feed_.state()->motors[motor].status == MotorStatus::kActive) active_.push_back(motor);
    }
    std::string why = sendOn(time);
    if (why.empty() && !interrupted()) {
      hearEvents();
      why = disobeyed(!obeyed_);
      if (why.empty()) why = atRest();
    }
    if (!why.empty()) return complain({why}, ExitCode::kFailed);
    printModules(global, {module_});
    return ExitCode::kOk;
  }

 private:
  // Until the time is over or Ctrl-C. Returns what went wrong, or nothing.
  std::string sendOn(Duration time) {
    const auto start = steady_clock::now();
    while (!interrupted()) {
      if (!feed_.pump()) return rc10dEnded().message;
      hearEvents();
      if (auto why = ended(); !why.empty()) return why;
      if (auto why = disobeyed(unheeded_.tooOften()); !why.empty()) return why;
      const auto now = steady_clock::now();
      if (now - start >= time) break;
      if (stream_.due(now, feed_.state()->mono_us)) {
        message_.received_ns = 0;  // the present time
        ++message_.seq;
        if (rc10d_.send(message_) == LinkClient::SendStatus::kClosed) return rc10dEnded().message;
        unheeded_.sent();
        stream_.sent(now);
      }
      waitReadable(rc10d_, std::min(stream_.next(), start + time) - steady_clock::now());
    }
    return {};
  }

  void hearEvents() {
    for (const auto& event : feed_.takeEvents()) {
      stream_.hear(event);
      if (auto why = client::refusalText(event, {}, kClientName); !why.empty()) refusal_ = std::move(why);
      if (event.code == static_cast<std::int32_t>(EventCode::kModuleRefused) &&
          event.source.view() == module_.name.view())
        module_refused_ = "module '" + name_ + "': " + printable(event.text.view()) +
                          ": `rc10ctl watch` shows the owner of each motor; stop that program";
    }
  }

  // Reason why its inputs are over: nothing that was stopped may begin anew by them.
  std::string ended() const {
    std::string why = stopped();
    if (why.empty()) why = stream_.ended(steady_clock::now());
    return why.empty() ? why : "the inputs of module '" + name_ + "' have ended: " + why;
  }

  // Empty, or what has stopped since the beginning, by the newest state.
  std::string stopped() const {
    const auto& state = *feed_.state();
    for (const auto motor : active_) {
      const std::string name = printable(rc10d_.welcome().motors[motor].name.view());
      if (auto why = client::obstacle(state, name, state.motors[motor]); !why.empty()) return why;
    }
    if (!runs_ || state.robot_state == RobotStatus::kRun) return {};
    return std::string{"the robot is in "} + toString(state.robot_state) + ": `rc10ctl clear`";
  }

  // Reason why the module does not do what it is told; empty if it does. `certain`: its state shows our
  // inputs by now, if it takes them.
  std::string disobeyed(bool certain) {
    const auto owner = module_.state.owner.view();
    if (owner == kClientName) {
      obeyed_ = true;
      unheeded_.heeded();
    }
    if (!module_refused_.empty()) return module_refused_;
    if (!certain || owner == kClientName) return {};
    if (owner.empty())
      return "module '" + name_ + "' takes none of these inputs" +
             (refusal_.empty() ? ": `rc10ctl stats` shows what was refused" : " (" + refusal_ + ")");
    return "module '" + name_ + "' is commanded by '" + printable(owner) +
           "': stop that program, or take over with a higher --priority";
  }

  // Where the module's motors are not known, the robot's state tells alone.
  std::string atRest() const {
    if (!motors_ && feed_.state()->robot_state == RobotStatus::kRun) return {};
    return whyAtRest(module_, watched_, rc10d_.welcome(), feed_.state());
  }

  std::vector<std::string> namesOf(const std::vector<std::size_t>& motors) const {
    std::vector<std::string> names;
    names.reserve(motors.size());
    for (const auto motor : motors) names.emplace_back(rc10d_.welcome().motors[motor].name.view());
    return names;
  }

  LinkClient& rc10d_;
  Feed& feed_;
  link::Signals& message_;
  const client::ModuleView& module_;
  std::string name_;
  std::optional<std::vector<std::size_t>> motors_;  // the module's, if the file can be read
  std::vector<std::size_t> watched_;                // a stop of one ends it; all, where they are not known
  std::vector<std::size_t> active_;                 // those that were, at the beginning
  bool runs_ = false;                               // the robot did
  client::CommandStream stream_;
  Unheeded unheeded_;
  bool obeyed_ = false;
  std::string refusal_;         // last word of rc10d about inputs that it refused
  std::string module_refused_;  // its word about the module's targets
};

ExitCode signal(const Global& global, const SignalOptions& options) {
  auto message = signalsFrom(options);
  if (!message) return complain(message.error(), ExitCode::kUsage);
  const auto time = client::parseDuration(options.time);
  if (!time)
    return complain({"--for " + options.time + ": give a time like 2s, 500ms or 1min, at most a day"},
                    ExitCode::kUsage);
  auto rc10d = connect(global, link::kModules | link::kEvents | link::kStates);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  Feed feed{*rc10d};
  if (const auto there = feed.awaitModules(); !there) return complain(there.error(), ExitCode::kFailed);
  if (const auto why = whySignalsUnfit(*message, feed.modules()); !why.empty())
    return complain({why}, ExitCode::kFailed);
  return Signalling(global, *rc10d, feed, *message).run(global, *time);
}

}  // namespace

void addModules(CLI::App& app, Action& action) {
  app.add_subcommand("modules", "the modules of the robot: what they take, what they give")
      ->callback([&action] { action = modules; });
}

void addSignal(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SignalOptions>();
  auto* verb = app.add_subcommand("signal", "gives a module its inputs for a while, then shows what it did");
  verb->add_option("module", options->module, "name of the module")->required()->type_name("MODULE");
  verb->add_option("values", options->values, "inputs: vx_m_s=0.5 wz_deg_s=30")
      ->required()
      ->type_name("NAME=NUMBER");
  verb->add_option("--for", options->time, "how long: 2s, 500ms, 1min")
      ->type_name("TIME")
      ->capture_default_str();
  verb->add_option("--priority", options->priority, "a higher one takes the module over from a lower one");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return signal(global, *options); }; });
}

}  // namespace rc10::ctl
