#include "daemon/daemon.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <thread>

#include <fmt/format.h>

#include "blackbox/places.hpp"
#include "config/check/bus_load.hpp"
#include "daemon/child_process.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/log.hpp"
#include "daemon/rest_frames.hpp"
#include "daemon/rt_process.hpp"
#include "daemon/service_notify.hpp"
#include "daemon/threads/loop_grids.hpp"
#include "daemon/threads/timer_kind.hpp"
#include "link/run_dir.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {
namespace {

constexpr int kSuperviseMs = 50;
// Below the scheduler: to the daemon the simulated drives are the outside world.
constexpr int kSimPriority = 50;
// Until rc10-guard takes ticks for stopped. Without real-time priority a busy computer stops them, too.
constexpr Duration kStandstillInRealTime = std::chrono::milliseconds{20};
constexpr Duration kStandstill = std::chrono::milliseconds{100};
constexpr int kStandstillPeriods = 4;

}  // namespace

Daemon::Daemon(RobotConfig config, std::shared_ptr<spdlog::logger> log)
    : config_(std::move(config)), log_(std::move(log)), inboxes_(config_.buses.size()) {}

Daemon::~Daemon() { stop(); }

// A shortcoming of the real-time set-up: an error where real time is required, else a notice.
Result<void> Daemon::tolerate(const Result<void>& outcome) {
  if (outcome) return {};
  if (config_.realtime == RealtimePolicy::kRequired) {
    return fail(outcome.error().message +
                ". (`realtime: preferred` in the configuration starts without it.)");
  }
  description_.realtime = false;
  description_.notices.push_back("not real-time: " + outcome.error().message);
  log_->warn("{}", description_.notices.back());
  return {};
}

Result<void> Daemon::start() {
  if (auto built = build(); !built) return built;
  cpu_latency_ = holdCpuDmaLatency();
  if (auto locked = tolerate(lockMemory()); !locked) return locked;
  if (auto started = startThreads(); !started) {
    stop();
    return started;
  }
  log_->info("robot '{}' runs: {} motors on {} buses at {} Hz{}; link {}", config_.robot,
             robot_->motors().size(), robot_->buses().size(), config_.rate_hz,
             description_.realtime ? "" : ", not real-time", link::socketPath(config_.robot));
  notifyService("READY=1");
  return {};
}

Result<void> Daemon::build() {
  // First what makes this the only rc10d of its robot and of its interfaces: another one must not notice.
  auto socket = LinkSocket::listen(link::runDir(), config_.robot);
  if (!socket) return tl::unexpected(socket.error());
  keepLog(*log_, link::logPath(link::runDir(), config_.robot));
  auto locks = InterfaceLocks::take(config_);
  if (!locks) return tl::unexpected(locks.error());
  interface_locks_ = std::move(*locks);
  if (auto prepared = prepareLinks(); !prepared) return prepared;
  auto robot = Robot::build(config_);
  if (!robot) return tl::unexpected(robot.error());
  robot_ = std::move(*robot);
  if (auto ours = interface_locks_.check(*robot_); !ours) return ours;
  if (auto written = writeRestFrames(*robot_, link::runDir(), config_.robot); !written) return written;
  if (auto guarded = findGuard(); !guarded) return guarded;
  describeRobot();
  tellWhoMayCommand();
  openBlackBox();  // the file is ours: no other daemon of this robot runs
  scheduler_ = std::make_unique<Scheduler>(*robot_, inboxes_, exchange_, config_.period(),
                                           black_box_ ? &black_box_->recorder() : nullptr, &monotonicNow);
  if (guard_) scheduler_->watchedBy(guard_->page());
  if (config_.heartbeat_gpio) scheduler_->restHeartbeatAfter(config_.heartbeat_gpio->rests_in_estop_after);
  if (auto created = createLoops(socket->estopDescriptor()); !created) return created;
  auto gpio_loop = GpioLoop::create(config_, exchange_);
  if (!gpio_loop) return tl::unexpected(gpio_loop.error());
  gpio_loop_ = std::move(*gpio_loop);
  // After the e-stop input and the heartbeat: they get a line that a module wants as well.
  if (auto* banks = robot_->lineBanks())
    line_loop_ = std::make_unique<LineLoop>(*banks, kernelGpio(), exchange_);
  io_loop_ = std::make_unique<IoLoop>(BusReviver{*robot_, inboxes_, exchange_, interface_locks_},
                                      CanLinkKeeper{*robot_, inboxes_, exchange_}, black_box_.get(),
                                      serialIo(), spiIo(), phase_watch_);
  if (config_.lcm.enabled) {
    gateway_ = std::make_unique<GatewayProcess>(
        siblingProgram("rc10-lcm"), std::vector<std::string>{"--socket", socket->path(), "--robot",
                                                             config_.robot, "--url", config_.lcm.url});
  }
  auto link =
      LinkServer::create(std::move(*socket), {.exchange = exchange_,
                                              .inboxes = inboxes_,
                                              .timing = sched_loop_->timing(),
                                              .robot = description_,
                                              .page_faults = [this] { return newPageFaults(); },
                                              .tick_thread = tickThread(),
                                              .log = [this](const link::Event& e) { logEvent(*log_, e); },
                                              .housekeeping = [this] { feedWatchdog(); }});
  if (!link) return tl::unexpected(link.error());
  link_ = std::move(*link);
  return {};
}

Result<void> Daemon::createLoops(int estop_socket) {
  intake_ = std::make_unique<CanIntake>(*robot_, inboxes_, monotonicNow());
  const Duration realtime_ahead = measureRealtimeOffset().ahead;
  const LoopGrids grids = loopGrids(config_, realtime_ahead);
  if (config_.phase_clock == PhaseClock::kRealtime)
    phase_watch_.emplace(grids.ticks, realtime_ahead, exchange_);
  const bool in_tick = config_.receive == ReceivePolicy::kTick;
  auto sched_loop = SchedLoop::create(*scheduler_,
                                      {.grid = grids.ticks,
                                       .timer = timerKind(config_.timer, kernelIsPreemptRt()),
                                       .overload = config_.overload,
                                       .realtime_percent = realtimePercent()},
                                      in_tick ? intake_.get() : nullptr);
  if (!sched_loop) return tl::unexpected(sched_loop.error());
  sched_loop_ = std::move(*sched_loop);
  std::optional<RxLoop::Drain> drain;
  if (!in_tick) drain.emplace(RxLoop::Drain{*intake_, grids.drains});
  auto rx_loop = RxLoop::create(robot_->serialChannels(), drain,
                                RxLoop::Estops{EstopDatagrams{estop_socket}, exchange_});
  if (!rx_loop) return tl::unexpected(rx_loop.error());
  rx_loop_ = std::move(*rx_loop);
  auto sim_loop = SimLoop::create(*robot_, grids.ticks, exchange_.shafts);
  if (!sim_loop) return tl::unexpected(sim_loop.error());
  sim_loop_ = std::move(*sim_loop);
  return {};
}

Result<void> Daemon::findGuard() {
  if (!config_.wantsGuard()) return {};
  const bool required = config_.realtime == RealtimePolicy::kRequired;
  const auto standstill = std::max<Duration>(required ? kStandstillInRealTime : kStandstill,
                                             kStandstillPeriods * config_.period());
  auto guard = GuardProcess::create(
      {.run_dir = link::runDir(),
       .program = siblingProgram("rc10-guard"),
       .hello = {.robot = config_.robot,
                 .standstill_ms = static_cast<std::uint32_t>(
                     std::chrono::duration_cast<std::chrono::milliseconds>(standstill).count()),
                 .rest_frames = restFramesText(*robot_, config_.robot)}});
  if (guard) {
    guard_ = std::move(*guard);
    return {};
  }
  const std::string message = "no guard: " + guard.error().message;
  if (config_.guard == GuardPolicy::kRequired)
    return fail(message + ". (`guard: preferred` in the configuration starts without it.)");
  description_.notices.push_back(message +
                                 "; if rc10d dies, the drives keep their last command until systemd "
                                 "runs rc10-stop");
  log_->warn("{}", description_.notices.back());
  return {};
}

void Daemon::superviseGuard() {
  if (!guard_) return;
  const auto news = guard_->supervise(monotonicNow());
  if (news.lost) exchange_.guard_lost.store(true, std::memory_order_release);
  if (!news.text.empty()) log_->warn("{}", news.text);
}

std::unique_ptr<SerialIo> Daemon::serialIo() {
  auto* lines = robot_->serialChannels();
  if (lines == nullptr) return nullptr;
  SerialReviver::Watch watch = [rx = rx_loop_.get()](std::size_t channel) {
    return rx->watchSerial(channel);
  };
  auto serial = std::make_unique<SerialIo>(
      SerialIo{SerialReviver{*lines, std::move(watch), exchange_}, SerialWriter{*lines}});
  serial->reviver.check(monotonicNow());  // present ports are open before the first tick
  return serial;
}

std::unique_ptr<SpiKeeper> Daemon::spiIo() {
  auto& lines = robot_->spiChannels();
  if (lines.empty()) return nullptr;
  return std::make_unique<SpiKeeper>(lines, exchange_, [](const std::string& path, std::uint32_t speed_hz) {
    return openSpiPort(path, speed_hz);
  });
}

void Daemon::tellWhoMayCommand() {
  if (!config_.lcm.leaves_computer) return;
  description_.notices.push_back(
      "LCM reaches the network (" + config_.lcm.url + "): every computer there may " +
      (config_.clients ? "stop this robot, and forge its state" : "command this robot"));
}

// Before the sockets are opened. Opening reports interfaces that are missing or no CAN.
Result<void> Daemon::prepareLinks() {
  for (const auto& bus : config_.buses) {
    if (bus.type != BusType::kSocketCan) continue;
    if (bus.manage_link) {
      if (auto restarted = restartCanLink(bus.interface, bus.linkSettings()); !restarted) {
        return fail("bus '" + bus.name + "': " + restarted.error().message);
      }
      log_->info("{}: {} brought up at {}", bus.name, bus.interface, bitrates(bus.linkSettings()));
      continue;
    }
    const auto link = readCanLink(bus.interface);
    const auto advice = link ? settingsAdvice(bus.interface, *link, bus.linkSettings()) : std::string{};
    if (advice.empty()) continue;
    description_.notices.push_back("at start: " + advice);
    log_->warn("{}: {}", bus.name, advice);
  }
  return {};
}

void Daemon::describeRobot() {
  description_.robot = config_.robot;
  description_.lcm_url = config_.lcm.enabled ? config_.lcm.url : "";
  description_.config_hash = config_.hash;
  description_.config_file = config_.file;
  description_.clients = config_.clients;
  description_.tuning_locked_at = config_.tuning_locked_at;
  description_.clear_local_at = config_.clear_local_at;
  description_.rate_hz = config_.rate_hz;
  description_.state_hz = config_.lcm.state_hz;
  if (config_.estop_gpio) description_.estop_input = config_.estop_gpio->pin.name();
  if (config_.enabling_gpio) description_.enabling_input = config_.enabling_gpio->pin.name();
  if (config_.mode_gpio) description_.mode_input = config_.mode_gpio->pin.name();
  for (const auto& bus : config_.buses) {
    const auto load = predictLoad(bus, config_.rate_hz);
    description_.buses.push_back({bus.name, bus.interface, static_cast<double>(bus.bitrate),
                                  static_cast<float>(load.unstuffed), static_cast<float>(load.worst_case),
                                  static_cast<double>(bus.data_bitrate)});
  }
  std::size_t index = 0;
  std::size_t port = 0;
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    const bool simulated = config_.buses[bus].type == BusType::kSimulated;
    for (std::size_t drive = 0; drive < config_.buses[bus].motors.size(); ++drive) {
      const auto& motor = config_.buses[bus].motors[drive];
      const auto& built = *robot_->motors()[index++].motor;
      const auto traits = motor.traits();
      description_.motors.push_back({motor.name(), std::string(built.modelName()), bus, motor.settings.id,
                                     built.modes(), motor.optional, traits.setup,
                                     MotorLoops{motor.settings.model, traits, motor.settings.loops}});
      auto& described = description_.motors.back();
      described.spring_range = springRangeOf(motor.settings, traits);
      described.max_first_step_deg = motor.shaping.max_first_step_deg;
      described.travel = motor.settings.travel;
      described.run_down = motor.run_down;
      auto use = motor.family->busUse(motor.settings);
      described.family = motor.family;
      described.sends = std::move(use.sends);
      described.steers = use.steering();
      if (simulated)
        described.simulated = {.port = port,
                               .drive = drive,
                               .direction = motor.settings.direction,
                               .payload_at_m = motor.simulated.payload_at_m};
    }
    port += simulated ? 1 : 0;
  }
  describeModules();
}

void Daemon::describeModules() {
  for (std::size_t i = 0; i < config_.modules.size(); ++i) {
    const auto& module = robot_->modules()[i];
    description_.modules.push_back(
        {module.name, std::string{config_.modules[i].type->name()}, module.module->signals()});
  }
}

void Daemon::openBlackBox() {
  if (config_.blackbox_mib == 0) return;
  auto opened = BlackBox::create(
      {.run_dir = link::runDir(), .state_dir = blackbox::stateDir(), .mib = config_.blackbox_mib},
      description_, log_);
  if (opened) {
    black_box_ = std::move(*opened);
    return;
  }
  description_.notices.push_back("no black box: " + opened.error().message);
  log_->warn("{}", description_.notices.back());
}

Result<void> Daemon::startThread(RtThread& thread, RtSettings settings,
                                 std::function<void(std::stop_token)> body) {
  auto started = thread.start(std::move(settings), std::move(body));
  if (started) return {};
  if (!thread.joinable()) return started;  // there is no thread at all
  return tolerate(started);
}

Result<void> Daemon::startThreads() {
  const auto rx = RtSettings{"rx", config_.rx.priority, config_.rx.cpu};
  const auto sched = RtSettings{"sched", config_.scheduler.priority, config_.scheduler.cpu};
  auto started =
      startThread(io_thread_, {"io", 0, {}}, [this](const std::stop_token& stop) { io_loop_->run(stop); });
  if (started && black_box_) {
    started = startThread(copy_thread_, {"copy", 0, {}},
                          [this](const std::stop_token& stop) { black_box_->runCopies(stop); });
  }
  if (started) {
    started = startThread(rx_thread_, rx, [this](const std::stop_token& stop) { rx_loop_->run(stop); });
  }
  if (started && gpio_loop_) {
    // Above the scheduler: the input is seen in the tick that follows.
    started = startThread(gpio_thread_, {"gpio", config_.scheduler.priority + 1, {}},
                          [this](const std::stop_token& stop) { gpio_loop_->run(stop, *scheduler_); });
  }
  if (started && line_loop_) {
    // Below the scheduler, which must not wait for a slow chip; above all that is not real-time, for an
    // output must go to its safe value on a busy computer too.
    started = startThread(line_thread_, {"lines", config_.scheduler.priority - 1, {}},
                          [this](const std::stop_token& stop) { line_loop_->run(stop, *scheduler_); });
  }
  if (started && !robot_->simPorts().empty()) {
    started = startThread(sim_thread_, {"sim", kSimPriority, {}},
                          [this](const std::stop_token& stop) { sim_loop_->run(stop); });
  }
  if (started) {
    started =
        startThread(sched_thread_, sched, [this](const std::stop_token& stop) { sched_loop_->run(stop); });
  }
  if (!started) return started;
  page_faults_at_start_ = pageFaults(rx_thread_.tid()) + pageFaults(sched_thread_.tid());
  cpu_rivals_.setThread(sched_thread_.tid());
  sched_stat_ = openSchedstat(sched_thread_.tid());
  return startThread(link_thread_, {"link", 0, {}},
                     [this](const std::stop_token& stop) { link_->run(stop); });
}

std::uint64_t Daemon::newPageFaults() const {
  return pageFaults(rx_thread_.tid()) + pageFaults(sched_thread_.tid()) - page_faults_at_start_;
}

ThreadFacts Daemon::tickThread() {
  return {.waited = [this] { return waitedForCpu(sched_stat_); },
          .page_faults = [this] { return pageFaults(sched_thread_.tid()); },
          .rivals = &cpu_rivals_};
}

void Daemon::feedWatchdog() {
  if (watchdog_.progressed(scheduler_->ticks(), rx_loop_->wakeUps())) notifyService("WATCHDOG=1");
}

void Daemon::waitForSignal(SignalInbox& signals) {
  for (;;) {
    superviseGuard();
    if (gateway_) {
      if (const auto news = gateway_->supervise(monotonicNow()); !news.empty()) log_->warn("{}", news);
    }
    if (gpio_loop_ && gpio_loop_->takeHeartbeatFailure() && config_.heartbeat_gpio) {
      log_->error("heartbeat_gpio: {} cannot be set: the relay behind it cuts the motors' power",
                  config_.heartbeat_gpio->pin.name());
    }
    std::array wait_for{pollfd{.fd = signals.descriptor(), .events = POLLIN, .revents = 0},
                        pollfd{.fd = guard_ ? guard_->descriptor() : -1, .events = POLLIN, .revents = 0}};
    if (::poll(wait_for.data(), wait_for.size(), kSuperviseMs) == 0) continue;
    while (const int signal = signals.take()) {
      switch (meaningOf(signal)) {
        case SignalMeaning::kChild: break;
        case SignalMeaning::kIgnored: log_->warn("{}: ignored", describeSignal(signal)); break;
        case SignalMeaning::kStop: log_->info("{}: stopping", describeSignal(signal)); return;
      }
    }
  }
}

void Daemon::stop() {
  notifyService("STOPPING=1");
  sched_thread_.join();  // goes on until rest frames are on the wire
  // Without a scheduler it did not start, and has commanded nothing.
  const bool rests = !scheduler_ || scheduler_->restEchoed();
  if (!rests)
    log_->error("not every bus has carried the rest frames: its drives may go on with their last command{}",
                guard_ ? "; rc10-guard sends rest until one is on the wire" : "");
  if (guard_) guard_->end(rests);
  line_thread_.join();  // leaves its outputs safe
  if (gateway_) gateway_->stop();
  link_thread_.join();
  rx_thread_.join();
  gpio_thread_.join();
  sim_thread_.join();
  copy_thread_.join();
  io_thread_.join();
  if (black_box_) black_box_->end();
  if (!sched_loop_ || scheduler_->ticks() == 0) return;
  const auto us = [](Duration d) { return std::chrono::duration<double, std::micro>(d).count(); };
  const auto& timing = sched_loop_->timing();
  log_->info(
      "{} ticks, {} missed; wake latency p50 {:.0f} p99 {:.0f} max {:.0f} us; tick p50 {:.1f} p99 {:.1f} max "
      "{:.1f} us",
      scheduler_->ticks(), scheduler_->missedTicks(), us(timing.wake_latency.percentile(0.5)),
      us(timing.wake_latency.percentile(0.99)), us(timing.wake_latency.max()),
      us(timing.duration.percentile(0.5)), us(timing.duration.percentile(0.99)), us(timing.duration.max()));
  sched_loop_.reset();
}

}  // namespace rc10
