#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/printable.hpp"
#include "client/duration_text.hpp"
#include "client/module_text.hpp"
#include "client/request_call.hpp"
#include "client/text_table.hpp"
#include "named_value.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

using std::chrono::steady_clock;

constexpr Duration kModulesPatience = std::chrono::seconds{3};

/// The modules of a robot, as far as they have told of themselves.
class ModuleFeed {
 public:
  explicit ModuleFeed(LinkClient& rc10d) : rc10d_(rc10d), buffer_(link::kMaxMessageSize) {
    const auto& welcome = rc10d.welcome();
    for (std::size_t i = 0; i < welcome.module_count; ++i)
      modules_.push_back({welcome.modules[i], link::ModuleInfo{}, link::ModuleState{}});
  }

  /// Takes what has come. False: rc10d has ended.
  [[nodiscard]] bool pump() {
    for (;;) {
      const auto received = rc10d_.receive(buffer_);
      if (received.status == LinkClient::ReceiveStatus::kClosed) return false;
      if (received.status == LinkClient::ReceiveStatus::kNothing) return true;
      take(received.datagram);
    }
  }

  /// Waits until each has told its state.
  [[nodiscard]] Result<void> awaitAll() {
    const auto deadline = steady_clock::now() + kModulesPatience;
    while (!complete()) {
      if (interrupted()) return fail("interrupted");
      if (steady_clock::now() >= deadline)
        return fail("rc10d sends nothing: is it stopped? See `systemctl status rc10d`");
      waitReadable(rc10d_, deadline - steady_clock::now());
      if (!pump()) return tl::unexpected(rc10dEnded());
    }
    return {};
  }

  [[nodiscard]] const std::vector<client::ModuleView>& modules() const noexcept { return modules_; }

 private:
  void take(std::span<const std::byte> datagram) {
    if (link::ModuleInfo info; link::open(datagram, info) && info.module < modules_.size()) {
      modules_[info.module].info = info;
    } else if (link::ModuleState state; link::open(datagram, state) && state.module < modules_.size()) {
      modules_[state.module].state = state;
    }
  }

  [[nodiscard]] bool complete() const {
    return std::all_of(modules_.begin(), modules_.end(),
                       [](const auto& module) { return module.state.mono_us != 0; });
  }

  LinkClient& rc10d_;
  std::vector<std::byte> buffer_;
  std::vector<client::ModuleView> modules_;
};

void printModules(const Global& global, const std::vector<client::ModuleView>& modules) {
  std::fputs((global.json ? client::modulesJson(modules) + "\n" : client::modulesText(modules)).c_str(),
             stdout);
}

ExitCode modules(const Global& global) {
  auto rc10d = connect(global, link::kModules);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  ModuleFeed feed{*rc10d};
  if (const auto there = feed.awaitAll(); !there) return complain(there.error(), ExitCode::kFailed);
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
               std::string(value.name.view()) + "'; it has: " + names;
    }
    return {};
  }
  return "there is no module '" + std::string(message.module.view()) + "'; there are: " + known;
}

ExitCode repeat(const Global& global, LinkClient& rc10d, link::Signals& message, Duration time,
                ModuleFeed& feed) {
  const auto start = steady_clock::now();
  auto next = start;
  while (!interrupted() && steady_clock::now() - start < time) {
    if (const auto now = steady_clock::now(); now >= next) {
      message.received_ns = 0;  // the present time
      ++message.seq;
      if (rc10d.send(message) == LinkClient::SendStatus::kClosed)
        return complain(rc10dEnded(), ExitCode::kFailed);
      next = std::max(next + kSendPeriod, now);
    }
    waitReadable(rc10d, std::min(next, start + time) - steady_clock::now());
    if (!feed.pump()) return complain(rc10dEnded(), ExitCode::kFailed);
  }
  printModules(global, feed.modules());
  return ExitCode::kOk;
}

ExitCode signal(const Global& global, const SignalOptions& options) {
  auto message = signalsFrom(options);
  if (!message) return complain(message.error(), ExitCode::kUsage);
  const auto time = client::parseDuration(options.time);
  if (!time)
    return complain({"--for " + options.time + ": give a time like 2s, 500ms or 1min, at most a day"},
                    ExitCode::kUsage);
  auto rc10d = connect(global, link::kModules);
  if (!rc10d) return complain(rc10d.error(), ExitCode::kNoDaemon);
  ModuleFeed feed{*rc10d};
  if (const auto there = feed.awaitAll(); !there) return complain(there.error(), ExitCode::kFailed);
  if (const auto why = whySignalsUnfit(*message, feed.modules()); !why.empty())
    return complain({why}, ExitCode::kFailed);
  return repeat(global, *rc10d, *message, *time, feed);
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
