#include "daemon/tick/scheduler.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "daemon/exchange/cycle_count.hpp"
#include "daemon/tick/tick_tracer.hpp"

namespace rc10 {
namespace {

// Longer gaps are not integrated over: the loops would jump.
constexpr std::uint64_t kMaxPeriods = 5;
// A stop sends rest at least this often, and gives up waiting for echoes after kMaxRestTicks and
// kLongestRest: the frames before it need their time on the wire at any rate of the tick.
constexpr int kMinRestTicks = 3;
constexpr int kMaxRestTicks = 50;
constexpr Duration kLongestRest = std::chrono::milliseconds{50};
// Longest time for the configured damping, braking or holding of moving motors before that.
constexpr Duration kLongestFallback = std::chrono::seconds{1};
// On a busy computer many ticks are late: they are reported together, at most this often.
constexpr Duration kMissedReportInterval = std::chrono::seconds{1};

}  // namespace

Scheduler::Scheduler(Robot& robot, std::span<BusInbox> inboxes, LinkExchange& link, Duration period,
                     FlightRecorder* recorder, Clock clock)
    : robot_(robot),
      inboxes_(inboxes),
      link_(link),
      period_(period),
      recorder_(recorder),
      clock_(clock),
      supervisor_(robot, link, recorder),
      modules_(robot, supervisor_, link, recorder),
      bus_watch_(robot, inboxes, supervisor_) {
  link_.ages.feedback = std::vector<DurationHistogram>(robot_.motors().size());
  if (recorder_ != nullptr) recorder_->listenTo(robot_);
}

void Scheduler::tick(MonotonicTime now, std::uint64_t periods) noexcept {
  const Tick tick{
      ticks_.load(std::memory_order_relaxed), now,
      seconds(period_ * static_cast<std::int64_t>(std::clamp<std::uint64_t>(periods, 1, kMaxPeriods)))};
  if (recorder_ != nullptr) recorder_->beginTick(now);
  if (periods > 1) {
    missed_ticks_ += periods - 1;
    unreported_missed_ticks_ += periods - 1;
  }
  reportMissedTicks(tick);
  receive();
  marks_.received = cycleCount();
  bus_watch_.decide(tick);
  stopForTheComputer(tick);
  supervisor_.receiveOrders(tick);
  if (stop_requested_) beginStop(tick);
  modules_.update(tick);
  driveDevices();
  marks_.moved = cycleCount();
  supervisor_.decide(tick);
  update(tick);
  const bool only_rest = stop_requested_ && !supervisor_.fallbackActs();
  pack(tick, only_rest);
  marks_.packed = cycleCount();
  bus_watch_.send(tick, only_rest);
  const MonotonicTime sent = clockOr(now);
  marks_.sent = cycleCount();
  bus_watch_.update(tick);
  if (only_rest) watchStop();
  snapshot(tick, sent);
  beat(tick);
  ticks_.store(tick.index + 1, std::memory_order_relaxed);
  if (guard_ == nullptr) return;
  guard_->ticks.store(tick.index + 1, std::memory_order_release);
  // In the last tick, not later by the main thread: the guard would miss ticks until then.
  if (stopped_ && rest_echoed_) guard_->ended.store(true, std::memory_order_release);
}

// Reasons to stop that neither a client nor the e-stop input has given.
void Scheduler::stopForTheComputer(const Tick& tick) noexcept {
  if (link_.guard_lost.exchange(false, std::memory_order_acquire))
    supervisor_.stopFor({StopCause::kGuard}, tick);
  if (guard_ != nullptr && guard_->acted.load(std::memory_order_acquire)) {
    guard_->acted.store(false, std::memory_order_release);
    supervisor_.stopFor({StopCause::kGuard}, tick);
    supervisor_.endFallbacks();  // the drives rest already: nothing takes them up again
  }
  if (stop_asked_.cause != StopCause::kNone) supervisor_.stopFor(std::exchange(stop_asked_, {}), tick);
}

void Scheduler::beat(const Tick& tick) noexcept {
  const auto estop = supervisor_.estopBegan();
  const bool rests = heartbeat_rests_after_ && estop && tick.now - *estop >= *heartbeat_rests_after_;
  if (!rests && !supervisor_.heartbeatRests())
    beats_.store(beats_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

void Scheduler::beginStop(const Tick& tick) noexcept {
  if (supervisor_.robotState() != RobotStatus::kStopping) stop_deadline_ = tick.now + kLongestFallback;
  supervisor_.beginStop(tick);
  if (tick.now >= stop_deadline_) supervisor_.endFallbacks();
}

void Scheduler::reportMissedTicks(const Tick& tick) noexcept {
  if (unreported_missed_ticks_ == 0 || tick.now < next_missed_report_) return;
  supervisor_.report({EventCode::kTicksMissed, Severity::kWarning, -1,
                      static_cast<std::int32_t>(std::min<std::uint64_t>(unreported_missed_ticks_, INT32_MAX)),
                      0, tick.now});
  unreported_missed_ticks_ = 0;
  next_missed_report_ = tick.now + kMissedReportInterval;
}

void Scheduler::receive() noexcept {
  for (std::size_t i = 0, count = robot_.buses().size(); i < count; ++i) {
    auto& bus = *robot_.buses()[i].bus;
    // Only what is there now: a flooded bus must not lengthen the tick without bound.
    inboxes_[i].frames.consume_all([&](const CanFrame& frame) {
      supervisor_.hearOnBus(i, frame);
      bus.dispatch(frame);
    });
  }
  for (auto& entry : robot_.serialDevices())
    deliver((*robot_.serialChannels())[entry.channel], *entry.device);
  for (auto& entry : robot_.gpioImages()) (*robot_.lineBanks())[entry.bank].look(*entry.image);
}

void Scheduler::driveDevices() noexcept {
  for (auto& entry : robot_.spiOutputs())
    handOver(*robot_.spiChannels()[entry.channel], *entry.output, entry.handed_over);
  // While the process stops the modules do not run any more, and what they wanted last is past.
  const bool stopping = supervisor_.robotState() == RobotStatus::kStopping;
  for (auto& entry : robot_.gpioImages()) {
    auto& bank = (*robot_.lineBanks())[entry.bank];
    bank.want(stopping ? bank.settings().safe_levels : entry.image->outputs);
  }
}

void Scheduler::update(const Tick& tick) noexcept {
  for (auto& entry : robot_.motors()) entry.motor->update(tick);
}

void Scheduler::pack(const Tick& tick, bool only_rest) noexcept {
  for (auto& entry : robot_.buses())
    only_rest ? entry.bus->packLastCommands(tick) : entry.bus->packCommands(tick);
  supervisor_.askOfScan(tick);
}

void Scheduler::watchStop() noexcept {
  if (rest_ticks_ == 0) {
    for (std::size_t i = 0; i < robot_.buses().size(); ++i) {
      confirmed_at_stop_[i] = inboxes_[i].confirmed.load(std::memory_order_relaxed);
    }
  }
  ++rest_ticks_;
  bool echoed = true;
  for (std::size_t i = 0; i < robot_.buses().size(); ++i) {
    if (inboxes_[i].echo_reads.load(std::memory_order_relaxed) == 0) continue;
    // So many echoes that frames from before the stop cannot account for all of them.
    echoed = echoed &&
             inboxes_[i].confirmed.load(std::memory_order_relaxed) >= confirmed_at_stop_[i] + kMinRestTicks;
  }
  const bool given_up = rest_ticks_ >= kMaxRestTicks && rest_ticks_ * period_ >= kLongestRest;
  stopped_ = (rest_ticks_ >= kMinRestTicks && echoed) || given_up;
  rest_echoed_ = echoed;
}

// Buses that refused or held back a frame since the last call.
std::bitset<kMaxBuses> Scheduler::keptFrames(const Snapshot& snapshot) noexcept {
  std::bitset<kMaxBuses> kept;
  for (std::size_t i = 0; i < snapshot.bus_count; ++i) {
    const auto& counters = snapshot.buses[i].counters;
    const std::uint64_t now = counters.tx_dropped + counters.tx_held;
    if (now != std::exchange(kept_[i], now)) kept.set(i);
  }
  return kept;
}

// Targets of a module are as old as its tick: the client's message to the module is counted instead. In a
// tick that tells a drive nothing no frame leaves, and of a bus that kept one it is not known whose.
void Scheduler::recordAges(const Snapshot& snapshot, const Tick& tick) noexcept {
  const auto kept = keptFrames(snapshot);
  const bool all_left = kept.none();
  auto* feedback_ages = link_.ages.feedback.data();
  const auto* entry = robot_.motors().data();
  for (std::size_t i = 0, count = snapshot.motor_count; i < count; ++i, ++entry) {
    const auto& motor = snapshot.motors[i];
    if (motor.acting != Acting::kTarget) continue;
    if (!all_left && kept[entry->bus]) {
      if (motor.command_received == tick.now) commands_[i] = tick.now;  // a module's, for which nobody waits
      continue;
    }
    const bool told = !entry->divided || entry->motor->due(tick);
    if (told) feedback_ages[i].record(snapshot.sent - motor.feedback.received);
    const MonotonicTime received = motor.command_received;
    if (received == commands_[i]) continue;
    const bool of_module = received == tick.now;
    if (!told && !of_module) continue;
    commands_[i] = received;
    if (!of_module) recordCommandAge(motor.owner, snapshot.sent - received);
  }
  // Motors of a module may be on any bus; one that is held carries nobody's frames.
  bool refused = false;
  for (std::size_t i = 0; !all_left && i < snapshot.bus_count; ++i)
    refused = refused || (kept[i] && !robot_.buses()[i].held);
  for (std::size_t i = 0; i < snapshot.module_count; ++i) {
    const auto& module = snapshot.modules[i];
    const MonotonicTime received = module.inputs_received;
    if (module.owner.view().empty()) continue;
    if (received != std::exchange(inputs_[i], received) && received != tick.now && !refused)
      recordCommandAge(module.owner, snapshot.sent - received);
  }
}

void Scheduler::recordCommandAge(const link::Name& client, Duration age) noexcept {
  link_.ages.command.record(age);
  link_.ages.clients.record(client, age);
}

void Scheduler::snapshot(const Tick& tick, MonotonicTime sent) noexcept {
  auto& out = link_.snapshot.slot();
  out.time = tick.now;
  out.sent = sent;
  out.tick = tick.index;
  out.missed_ticks = missed_ticks_;
  supervisor_.fillSnapshot(out);
  modules_.fillSnapshot(out);
  out.bus_count = robot_.buses().size();
  for (std::size_t i = 0; i < out.bus_count; ++i) {
    const auto& bus = *robot_.buses()[i].bus;
    out.buses[i] = {.counters = bus.counters(),
                    .state = bus.health().state(),
                    .tec = bus.health().transmitErrors(),
                    .rec = bus.health().receiveErrors(),
                    .error_frames = bus.health().errorFrames(),
                    .restarts = bus.health().restarts()};
  }
  recordAges(out, tick);
  if (recorder_ != nullptr) recorder_->states(out);
  trace(out, link_.trace);
  link_.snapshot.publish();
}

}  // namespace rc10
