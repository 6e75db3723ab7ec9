#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "can_link_facts.hpp"
#include "client/daemon_log.hpp"
#include "config/build/lcm_url.hpp"
#include "config/load_config.hpp"
#include "doctor/cpu_check.hpp"
#include "doctor/daemon_check.hpp"
#include "doctor/host_files.hpp"
#include "doctor/interrupt_threads.hpp"
#include "doctor/irq_check.hpp"
#include "doctor/kernel_check.hpp"
#include "doctor/limits_check.hpp"
#include "doctor/multicast_check.hpp"
#include "doctor/report.hpp"
#include "feed.hpp"
#include "latency_test.hpp"
#include "link/interface_lock.hpp"
#include "multicast_source.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

constexpr const char* kDefaultConfig = "/etc/rc10d/robot.yaml";
constexpr double kLatencySeconds = 10.0;

struct DoctorOptions {
  std::optional<std::string> config;
  std::optional<double> latency_s;
};

class Doctor {
 public:
  Doctor(const Global& global, const std::optional<RobotConfig>& config)
      : global_(global),
        config_(config),
        robot_(config.value_or(RobotConfig{})),
        processes_(doctor::readProcesses(files_)),
        daemons_(doctor::readDaemons(files_, processes_)) {}

  void examineComputer() {
    const auto kernel = doctor::readKernel(files_);
    tell(doctor::checkPreemption(kernel));
    tell(doctor::checkThrottling(kernel));
    tell(doctor::checkCompaction(kernel));
    examineLimits();
    const auto cpus = doctor::readCpus(files_);
    tell(doctor::checkGovernor(cpus));
    tell(doctor::checkIsolation(
        cpus, {.scheduler = robot_.scheduler.cpu, .rx = robot_.rx.cpu, .rx_reads_can = rxReadsCan()}));
  }

  void examineBuses() {
    std::map<std::string, std::string> holders;
    const auto wanted = links();
    for (const auto& facts : wanted) {
      for (const auto& finding : doctor::checkCanLink(facts)) tell(finding);
      if (!facts.link) continue;
      tell(doctor::checkInterruptThreads(
          facts.interface, doctor::threadsOf(facts.interface, files_, processes_),
          {.priority = rxReadsCan() ? robot_.rx.priority : robot_.scheduler.priority,
           .is_rx = rxReadsCan()}));
      holders[facts.interface] = link::holderOfInterface(facts.interface);
    }
    if (wanted.empty()) tell(noInterfaces());
    examineMulticast();
    tell(doctor::checkOneDaemon(daemons_, holders, config_ ? robot_.robot : ""));
    tell(doctor::checkSandbox(daemons_, doctor::serviceInstalled(files_)));
  }

  // rc10d's own figures are the truth about it; a test beside it would only disturb it.
  void examineLatency(std::optional<double> wanted_s) {
    if (!wanted_s && !daemons_.empty() && takeDaemonsLatency()) return;
    const double time_s = wanted_s.value_or(kLatencySeconds);
    if (time_s <= 0.0) return;
    if (!global_.json && ::isatty(STDERR_FILENO) != 0)
      std::fprintf(stderr, "measuring for %g s...\n", time_s);
    doctor::LatencyHistogram histogram;
    const auto facts =
        measureLatency({.time = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(time_s)),
                        .grid = {robot_.period(), robot_.phase()},
                        .priority = robot_.scheduler.priority,
                        .cpu = robot_.scheduler.cpu},
                       histogram);
    if (histogram.count() == 0) return;
    tell(doctor::checkLatency(facts));
    std::fputs((global_.json ? doctor::json(histogram) + "\n" : doctor::text(histogram)).c_str(), stdout);
  }

  ExitCode finish() const {
    if (!global_.json) std::fputs(doctor::summary(findings_).c_str(), stdout);
    return doctor::worst(findings_) == doctor::Verdict::kFail ? ExitCode::kFailed : ExitCode::kOk;
  }

 private:
  void tell(doctor::Finding finding) {
    std::fputs((global_.json ? doctor::json(finding) + "\n" : doctor::text(finding, coloured(STDOUT_FILENO)))
                   .c_str(),
               stdout);
    std::fflush(stdout);
    findings_.push_back(std::move(finding));
  }

  bool rxReadsCan() const { return robot_.receive == ReceivePolicy::kThread; }

  void examineLimits() {
    const bool runs = !daemons_.empty();
    const std::string pid = runs ? std::to_string(daemons_.front().pid) : "self";
    const std::string who = runs ? "rc10d (pid " + pid + ")" : "this shell";
    const auto limits = doctor::readLimits(files_, pid);
    const bool service = !runs && doctor::serviceInstalled(files_);
    // The threads of the e-stop input and the heartbeat are one above the scheduler's. Without a
    // configuration there may be real buses, which a guard watches.
    const doctor::PriorityNeeds needs{.rc10d = std::max(robot_.rx.priority, robot_.scheduler.priority + 1),
                                      .guard = !config_ || robot_.wantsGuard()};
    tell(doctor::checkRealtimeLimit(limits, who, service, needs));
    tell(doctor::checkMemoryLimit(limits, who, service));
  }

  // Those of the configuration; without one, those that are there.
  std::vector<doctor::CanLinkFacts> links() const {
    std::vector<doctor::CanLinkFacts> links;
    for (const auto& bus : robot_.buses) {
      if (bus.type != BusType::kSocketCan) continue;
      auto facts = readLink(files_, bus.interface);
      facts.wanted = bus.linkSettings();
      facts.managed = bus.manage_link;
      links.push_back(std::move(facts));
    }
    if (!config_)
      for (const auto& interface : doctor::canInterfaces(files_))
        links.push_back(readLink(files_, interface));
    return links;
  }

  doctor::Finding noInterfaces() const {
    if (config_) return doctor::pass("CAN interfaces", "the configuration has simulated buses only");
    return doctor::warn("CAN interfaces", "this computer has none: only simulated buses (`type: sim`) work",
                        "a HAT needs its overlay in /boot/firmware/config.txt (docs/can-setup.md); virtual: "
                        "sudo ip link add vcan0 type vcan");
  }

  void examineMulticast() {
    if (!robot_.lcm.enabled) return;
    const auto url = parseLcmUrl(robot_.lcm.url);
    if (!url) return;
    tell(doctor::checkMulticast(doctor::routeOf(files_, url->group), multicastSource(url->group), url->group,
                                url->ttl));
  }

  bool takeDaemonsLatency() {
    auto rc10d = connect(global_, link::kDiagnosticsFeed | link::kStates);
    if (!rc10d) return false;
    Feed feed(*rc10d);
    if (!feed.awaitDiagnostics() || !feed.awaitState()) return false;
    const auto& seen = feed.diagnostics()->wake_latency;
    const auto micros = [](float us) {
      return std::chrono::duration_cast<Duration>(std::chrono::duration<float, std::micro>(us));
    };
    tell(doctor::checkLatency({.period = std::chrono::microseconds{feed.diagnostics()->tick_period_us},
                               .p50 = micros(seen.p50_us),
                               .p99 = micros(seen.p99_us),
                               .p999 = micros(seen.p999_us),
                               .max = micros(seen.max_us),
                               .wake_ups = 0,
                               .realtime = feed.state()->realtime != 0,
                               .refused = client::kSeeItsLog,
                               .by = "rc10d itself, since its start"}));
    return true;
  }

  const Global& global_;
  const std::optional<RobotConfig>& config_;
  RobotConfig robot_;  // the defaults where no configuration was given
  doctor::HostFiles files_;
  std::vector<doctor::Process> processes_;
  std::vector<doctor::DaemonFacts> daemons_;
  doctor::Findings findings_;
};

ExitCode examine(const Global& global, const DoctorOptions& options) {
  std::optional<RobotConfig> config;
  const bool installed = ::access(kDefaultConfig, R_OK) == 0;
  if (options.config || installed) {
    auto outcome = loadRobotConfig(options.config.value_or(kDefaultConfig));
    if (!outcome.config) {
      std::fputs(outcome.errorText().c_str(), stderr);
      return complain({"the configuration is wrong: mend it, then run doctor again"}, ExitCode::kFailed);
    }
    config = std::move(outcome.config);
  }
  Doctor doctor(global, config);
  doctor.examineComputer();
  doctor.examineBuses();
  doctor.examineLatency(options.latency_s);
  return doctor.finish();
}

}  // namespace

void addDoctor(CLI::App& app, Action& action) {
  const auto options = std::make_shared<DoctorOptions>();
  auto* verb = app.add_subcommand(
      "doctor", "whether this computer can run a robot well, and the commands that mend it");
  verb->add_option("--config", options->config,
                   "the robot's configuration, default /etc/rc10d/robot.yaml if there is one")
      ->type_name("FILE");
  verb->add_option("--latency-seconds", options->latency_s,
                   "how long to measure wake-ups, default 10; 0: not at all. Default while rc10d runs: its "
                   "own figures")
      ->check(CLI::Range(0.0, 604800.0))
      ->type_name("S");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return examine(global, *options); }; });
}

}  // namespace rc10::ctl
