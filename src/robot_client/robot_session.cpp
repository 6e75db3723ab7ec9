#include "robot_client/robot_session.hpp"

#include <pthread.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdio>

#include "app/message_limits.hpp"
#include "rc10/command_t.hpp"
#include "rc10/request_t.hpp"
#include "robot_client/convert.hpp"
#include "robot_client/event_codes.hpp"
#include "robot_client/host_clock.hpp"
#include "robot_client/motor_reasons.hpp"
#include "robot_client/obstacle.hpp"
#include "robot_client/robots_heard.hpp"
#include "robot_client/session_number.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using std::chrono::milliseconds;

// LCM allows 63 characters for a channel, and ".v1.diagnostics" takes 15 of them.
constexpr std::size_t kMaxRobotName = 48;

// A request or its answer can be lost: LCM is UDP. rc10d knows a repeated one again.
constexpr Duration kRepeatRequest = milliseconds{100};
// An emergency stop is worth the traffic.
constexpr Duration kRepeatEstop = milliseconds{20};
// A state younger than this proves that rc10d runs and is heard; without one, nothing is held.
constexpr Duration kLive = milliseconds{1000};
// For the state to show what an answer says.
constexpr Duration kShown = milliseconds{250};
constexpr Duration kRelease = milliseconds{500};
constexpr Duration kLookAtMoves = milliseconds{20};
constexpr Duration kReportAgain = milliseconds{1000};
constexpr Duration kListen = milliseconds{300};
// A state that is older than the known one by less than this has been overtaken on its way.
constexpr std::int64_t kOvertakenUs = 1'000'000;

[[nodiscard]] std::int64_t wallUs() {
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(wall).count();
}

[[nodiscard]] std::string programName() {
  return std::string(program_invocation_short_name).substr(0, kMaxNameBytes);
}

[[nodiscard]] std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

[[nodiscard]] std::string inMs(Duration duration) {
  return std::to_string(std::chrono::duration_cast<milliseconds>(duration).count()) + " ms";
}

[[nodiscard]] bool isChannelName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxRobotName && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
  });
}

[[nodiscard]] tl::unexpected<RequestError> notSent(std::string message) {
  return tl::unexpected(RequestError{RequestError::Kind::kNotSent, std::move(message), {}});
}

}  // namespace

RobotSession::RobotSession(std::string name, const Link& link, RobotOptions options)
    : name_(std::move(name)),
      link_(link),
      options_(std::move(options)),
      session_(newSessionNumber()),
      status_(checkOptions()),
      held_(options_.resend, options_.alive_within) {
  if (options_.client.empty()) options_.client = programName();
  if (!status_) return;
  subscriptions_.push_back(link_.subscribe(channel("state"), [this](auto bytes) { receiveState(bytes); }));
  subscriptions_.push_back(link_.subscribe(channel("event"), [this](auto bytes) { receiveEvent(bytes); }));
  subscriptions_.push_back(
      link_.subscribe(channel("response"), [this](auto bytes) { receiveResponse(bytes); }));
  sender_ = std::thread([this] { sendLoop(); });
  pthread_setname_np(sender_.native_handle(), "rc10-hold");
}

RobotSession::~RobotSession() {
  if (const auto closed = close(); !closed) report("leaving " + name_ + ": " + closed.error().message);
}

Result<void> RobotSession::checkOptions() const {
  if (!isChannelName(name_)) {
    return fail("'" + name_ + "' is no robot's name: that has letters, digits, '_', '-' and '.', 48 at most");
  }
  if (options_.client.size() > kMaxNameBytes) {
    return fail("the client's name '" + options_.client + "' is longer than " +
                std::to_string(kMaxNameBytes) + " bytes");
  }
  if (options_.validity < milliseconds{1} || options_.validity > milliseconds{1000}) {
    return fail("validity is not within 1 to 1000 ms");
  }
  if (options_.resend < milliseconds{0} || options_.resend >= options_.validity) {
    return fail("resend has to be shorter than validity, or the motors coast between two messages");
  }
  if (options_.alive_within < milliseconds{0}) return fail("alive_within is negative");
  return link_.status();
}

// ---- receiving, on the link's thread -------------------------------------------------------------------

void RobotSession::receiveState(std::span<const std::byte> bytes) {
  robot_state_t message;
  if (!Link::decode(bytes, message)) return foreign(channel("state"));
  const auto now = timeNow();
  auto state = std::make_shared<RobotState>(fromLcm(message));
  std::shared_ptr<std::function<void(const RobotState&)>> callback;
  News news;
  {
    const Lock lock(mutex_);
    if (closed_) return;
    const auto overtaken_us = state_ ? state_->mono_us - state->mono_us : 0;
    if (0 < overtaken_us && overtaken_us < kOvertakenUs) return;
    state->taken = clock_.observe(std::chrono::microseconds{state->mono_us}, now);
    state_ = state;
    last_state_ = now;
    ++states_received_;
    if (state->status == RobotStatus::kEstop) estop_seq_.reset();
    for (std::size_t i = moves_.size(); i-- > 0;) {
      if (auto result = moves_[i].watch.onState(*state, now)) finish(i, std::move(*result), news);
    }
    drop(held_.judge(*state, options_.client), news);
    callback = on_state_;
  }
  changed_.notify_all();
  tell(std::move(news));
  if (callback && *callback) (*callback)(*state);
}

void RobotSession::receiveEvent(std::span<const std::byte> bytes) {
  event_t message;
  if (!Link::decode(bytes, message)) return foreign(channel("event"));
  const auto event = fromLcm(message);
  std::shared_ptr<std::function<void(const Event&)>> callback;
  bool concerns_us = event.code == kOtherDefinitions;
  {
    const Lock lock(mutex_);
    if (closed_) return;
    for (auto& move : moves_) move.watch.onEvent(event);
    const bool names_us = event.text.find('\'' + options_.client + '\'') != std::string::npos;
    concerns_us = concerns_us || (event.code == kSetpointSkipped && held_.holds(event.source)) ||
                  (names_us && (event.code == kNotOwner || event.code == kCommandRefused));
    callback = on_event_;
  }
  if (concerns_us) report("rc10d says: " + event.source + ": " + event.text);
  if (callback && *callback) (*callback)(event);
}

void RobotSession::receiveResponse(std::span<const std::byte> bytes) {
  response_t message;
  if (!Link::decode(bytes, message)) return foreign(channel("response"));
  // All clients of the robot hear all answers.
  if (message.session != session_ || message.client != options_.client) return;
  {
    const Lock lock(mutex_);
    const auto open = open_.find(message.seq);
    if (open == open_.end() || open->second) return;
    open->second = std::move(message);
    states_at_answer_ = states_received_;
  }
  changed_.notify_all();
}

void RobotSession::foreign(const std::string& channel) {
  {
    const Lock lock(mutex_);
    if (!foreign_.insert(channel).second) return;
  }
  report(channel +
         " carries messages with other definitions than this program's: build it with the rc10 that "
         "belongs to this rc10d");
}

// ---- commanding ------------------------------------------------------------------------------------------

Result<void> RobotSession::mayCommand(const MotorSetpoints& setpoints, MonotonicTime now) const {
  if (closed_) return fail("the robot is closed");
  if (setpoints.empty()) return fail("a command needs at least one setpoint");
  if (!state_) {
    return fail("no state of robot '" + name_ +
                "' has come yet: call waitForState(), which says what to check");
  }
  if (now > last_state_ + kLive) {
    return fail("no state of robot '" + name_ + "' for a second: rc10d or rc10-lcm has ended, or hangs");
  }
  for (std::size_t i = 0; i < setpoints.size(); ++i) {
    const auto& [motor, setpoint] = setpoints[i];
    if (auto checked = setpoint.check(); !checked) return fail(motor + ": " + checked.error().message);
    for (std::size_t j = 0; j < i; ++j) {
      if (setpoints[j].motor == motor) return fail("two setpoints for " + motor);
    }
    // Coasting needs nothing but a motor.
    if (setpoint.mode == Mode::kCoast && state_->find(motor) != nullptr) continue;
    if (auto reason = obstacle(*state_, motor, setpoint.mode)) return fail(*reason);
  }
  return {};
}

Result<void> RobotSession::command(const MotorSetpoints& setpoints) {
  if (!status_) return status_;
  const auto now = timeNow();
  News news;
  Result<void> done;
  {
    const Lock lock(mutex_);
    done = mayCommand(setpoints, now);
    if (done) {
      supersede(setpoints, news);
      done = publishCommand(setpoints, options_.validity);
      if (options_.resend != milliseconds{0}) held_.set(setpoints, now);
    }
  }
  wake_sender_.notify_all();
  tell(std::move(news));
  if (!done) report(done.error().message);
  return done;
}

std::future<MoveResult> RobotSession::moveTo(const MoveGoal& goal) {
  const MotorSetpoints setpoints{{goal.motor, goal.mode == Mode::kAngle
                                                  ? Setpoint::angle(Degrees{goal.target_deg})
                                                  : Setpoint::totalAngle(Degrees{goal.target_deg})}};
  const auto now = timeNow();
  Move move{MoveWatch(goal, options_.client, now), {}};
  auto future = move.promise.get_future();
  News news;
  {
    const Lock lock(mutex_);
    auto possible = status_ ? mayCommand(setpoints, now) : status_;
    if (possible && options_.resend == milliseconds{0}) {
      possible = fail("moveTo() needs held targets: RobotOptions::resend is 0");
    }
    if (possible && !(goal.tolerance_deg > 0.0))
      possible = fail("the tolerance of moveTo() has to be above 0");
    if (possible) {
      supersede(setpoints, news);
      possible = publishCommand(setpoints, options_.validity);
    }
    if (possible) {
      held_.set(setpoints, now);
      moves_.push_back(std::move(move));
    } else {
      news.results.emplace_back(std::move(move.promise), move.watch.failed(possible.error().message));
    }
  }
  wake_sender_.notify_all();
  tell(std::move(news));
  return future;
}

void RobotSession::alive() {
  const Lock lock(mutex_);
  held_.alive(timeNow());
}

Result<void> RobotSession::publishCommand(const MotorSetpoints& setpoints, milliseconds validity) {
  command_t message;
  message.utime = wallUs();
  message.client = options_.client;
  message.session = session_;
  message.seq = ++seq_;
  message.priority = options_.priority;
  message.validity_ms = static_cast<std::int32_t>(validity.count());
  for (const auto& order : setpoints) {
    message.setpoints.push_back(toLcm(order));
    commanded_.insert(order.motor);
  }
  message.setpoint_count = static_cast<std::int32_t>(message.setpoints.size());
  return link_.publish(channel("command"), message);
}

void RobotSession::supersede(const MotorSetpoints& setpoints, News& news) {
  for (const auto& order : setpoints) {
    for (std::size_t i = moves_.size(); i-- > 0;) {
      if (moves_[i].watch.motor() != order.motor) continue;
      news.results.emplace_back(std::move(moves_[i].promise),
                                moves_[i].watch.failed(order.motor + " was given another target"));
      moves_.erase(moves_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

void RobotSession::finish(std::size_t move, MoveResult result, News& news) {
  if (result.outcome == MoveResult::Outcome::kFailed) held_.release(moves_[move].watch.motor());
  news.results.emplace_back(std::move(moves_[move].promise), std::move(result));
  moves_.erase(moves_.begin() + static_cast<std::ptrdiff_t>(move));
}

void RobotSession::drop(const std::vector<HeldTargets::Dropped>& dropped, News& news) {
  for (const auto& [motor, reason] : dropped) {
    news.problems.push_back("target dropped: " + reason);
    for (std::size_t i = moves_.size(); i-- > 0;) {
      if (moves_[i].watch.motor() == motor) finish(i, moves_[i].watch.failed(reason), news);
    }
  }
}

// ---- modules ---------------------------------------------------------------------------------------------

const ModuleInbox& RobotSession::inboxOf(const std::string& module) {
  const Lock lock(mutex_);
  auto& inbox = modules_[module];
  if (!inbox) inbox = std::make_unique<const ModuleInbox>(link_, channel(module));
  return *inbox;
}

Result<void> RobotSession::send(const std::string& module, const Signals& inputs,
                                const SendOptions& options) {
  if (!status_) return status_;
  auto done = checkInputs(module, inputs, options);
  if (done) {
    signals_t message;
    message.utime = wallUs();
    message.client = options_.client;
    message.session = session_;
    message.priority = options.priority.value_or(options_.priority);
    message.validity_ms = static_cast<std::int32_t>(options.validity.count());
    message.count = static_cast<std::int32_t>(inputs.size());
    for (const auto& [name, value] : inputs) {
      message.names.push_back(name);
      message.values.push_back(value);
    }
    // Numbered and sent under the mutex: another thread's message with a higher number must not overtake it.
    const Lock lock(mutex_);
    message.seq = ++seq_;
    held_.alive(timeNow());
    done = closed_ ? fail("the robot is closed") : link_.publish(channel(module), message);
  }
  if (!done) report(done.error().message);
  return done;
}

ModuleState RobotSession::moduleState(const std::string& module) { return inboxOf(module).state(); }

double RobotSession::moduleOutput(const std::string& module, std::string_view output) {
  const auto state = moduleState(module);
  if (state && state.outputs.find(output) == state.outputs.end()) {
    report(module + " has no output '" + std::string(output) + "'; there are " + state.outputNames());
  }
  return state[output];
}

Result<void> RobotSession::waitForModule(const std::string& module, Duration timeout) {
  if (!status_) return status_;
  if (link_.inHandler()) return fail("waitForState() in a callback would wait for itself");
  const auto& inbox = inboxOf(module);
  if (inbox.waitForNext(timeout)) return {};
  if (inbox.foreign()) foreign(channel(module) + ".state");
  return fail("nothing of module '" + module + "' within " + inMs(timeout) +
              ": `rc10ctl modules` shows which there are. " + whatToCheck());
}

// ---- sending again ---------------------------------------------------------------------------------------

void RobotSession::resend(MonotonicTime now, News& news) {
  drop(held_.lapse(now), news);
  if (state_ && now > last_state_ + kLive && !held_.motors().empty()) {
    std::vector<HeldTargets::Dropped> dropped;
    for (const auto& motor : held_.motors()) dropped.push_back({motor, motor + ": no state for a second"});
    held_.releaseAll();
    drop(dropped, news);
  }
  for (std::size_t i = moves_.size(); i-- > 0;) {
    if (auto result = moves_[i].watch.onTime(now)) finish(i, std::move(*result), news);
  }
  for (const auto& message : held_.takeDue(now)) (void)publishCommand(message, options_.validity);
  if (estop_seq_ && now >= next_estop_) {
    (void)publishRequest(*estop_seq_, "estop", "", {});
    next_estop_ = now + kRepeatEstop;
  }
}

MonotonicTime RobotSession::nextWake(MonotonicTime now) const {
  auto next = now + std::chrono::hours{1};
  if (const auto due = held_.nextDue()) next = std::min(next, *due);
  if (estop_seq_) next = std::min(next, next_estop_);
  for (const auto& move : moves_) next = std::min({next, move.watch.deadline(), now + kLookAtMoves});
  return next;
}

void RobotSession::sendLoop() {
  Lock lock(mutex_);
  while (!closed_) {
    const auto now = timeNow();
    News news;
    resend(now, news);
    if (!news.results.empty() || !news.problems.empty()) {
      lock.unlock();
      tell(std::move(news));
      lock.lock();
      continue;
    }
    wake_sender_.wait_until(lock, nextWake(now));
  }
}

void RobotSession::tell(News&& news) {
  for (auto& [promise, result] : news.results) promise.set_value(std::move(result));
  for (const auto& problem : news.problems) report(problem);
}

void RobotSession::report(const std::string& problem) {
  {
    const Lock lock(mutex_);
    const auto now = timeNow();
    std::erase_if(reported_, [&](const auto& entry) { return now >= entry.second + kReportAgain; });
    if (!reported_.emplace(problem, now).second) return;
  }
  if (options_.on_problem) {
    options_.on_problem(problem);
  } else {
    std::fprintf(stderr, "rc10: %s: %s\n", name_.c_str(), problem.c_str());
  }
}

// ---- states
// ------------------------------------------------------------------------------------------------

Result<void> RobotSession::waitForState(Duration timeout) {
  if (!status_) return status_;
  if (link_.inHandler()) return fail("waitForState() in a callback would wait for itself");
  {
    Lock lock(mutex_);
    const auto known = states_received_;
    if (changed_.wait_for(lock, timeout, [&] { return states_received_ > known; })) return {};
  }
  return fail("no state of robot '" + name_ + "' within " + inMs(timeout) + ". " + whatToCheck());
}

std::string RobotSession::whatToCheck() {
  {
    const Lock lock(mutex_);
    if (!foreign_.empty()) {
      return "Messages with other definitions arrive on " + *foreign_.begin() +
             ": build this program with the rc10 that belongs to this rc10d.";
    }
    if (state_ && timeNow() < last_state_ + kLive) {
      return "Its state arrives, so rc10d runs and is heard: see rc10d's log for the reason.";
    }
  }
  if (const auto names = RobotsHeard(link_).names(kListen); !names.empty()) {
    return "Heard here: robot " + names + ": is the name right?";
  }
  return "Check: is rc10d running (rc10ctl list)? Is its robot called '" + name_ +
         "' (robot: in its configuration)? Does multicast stay on this computer: 'ip route get "
         "239.255.76.67' "
         "must say 'dev lo', else run: sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1";
}

std::shared_ptr<const RobotState> RobotSession::state() {
  const Lock lock(mutex_);
  return state_;
}

void RobotSession::onState(std::function<void(const RobotState&)> callback) {
  auto shared = std::make_shared<std::function<void(const RobotState&)>>(std::move(callback));
  const Lock lock(mutex_);
  on_state_ = std::move(shared);
}

void RobotSession::onEvent(std::function<void(const Event&)> callback) {
  auto shared = std::make_shared<std::function<void(const Event&)>>(std::move(callback));
  const Lock lock(mutex_);
  on_event_ = std::move(shared);
}

// ---- requests
// ----------------------------------------------------------------------------------------------

Result<void> RobotSession::publishRequest(std::int64_t seq, const std::string& operation,
                                          const std::string& target,
                                          const std::map<std::string, double>& values) {
  request_t message;
  message.utime = wallUs();
  message.client = options_.client;
  message.session = session_;
  message.seq = seq;
  message.operation = operation;
  message.target = target;
  for (const auto& [name, value] : values) {
    named_value_t named;
    named.name = name;
    named.value = value;
    message.values.push_back(std::move(named));
  }
  message.value_count = static_cast<std::int32_t>(message.values.size());
  return link_.publish(channel("request"), message);
}

RequestResult RobotSession::request(const std::string& operation, const std::vector<std::string>& motors,
                                    const std::map<std::string, double>& values, Duration timeout) {
  for (const auto& name : motors) {
    // An empty name would be understood as "all", a comma as two names.
    if (name.empty() || name.find(',') != std::string::npos)
      return notSent("'" + name + "' is no motor's name");
    const auto known = state();
    if (known && known->find(name) == nullptr) {
      return notSent("there is no motor '" + name + "'; the motors are: " + known->motorNames());
    }
  }
  return request(operation, joined(motors), values, timeout);
}

RequestResult RobotSession::request(const std::string& operation, const std::string& target,
                                    const std::map<std::string, double>& values, Duration timeout) {
  if (!status_) return notSent(status_.error().message);
  if (link_.inHandler()) return notSent(operation + " waits for an answer: not in a callback");
  const auto deadline = timeNow() + timeout;
  std::optional<response_t> answer;
  {
    Lock lock(mutex_);
    const auto seq = ++seq_;
    open_[seq] = std::nullopt;
    for (auto now = timeNow(); now < deadline && !answer; now = timeNow()) {
      if (auto sent = publishRequest(seq, operation, target, values); !sent) {
        open_.erase(seq);
        return notSent(sent.error().message);
      }
      changed_.wait_until(lock, std::min(deadline, now + kRepeatRequest),
                          [&] { return open_[seq].has_value(); });
      answer = open_[seq];
    }
    open_.erase(seq);
  }
  if (!answer) {
    return tl::unexpected(RequestError{RequestError::Kind::kNoAnswer,
                                       "no answer to '" + operation + "' from robot '" + name_ + "' within " +
                                           inMs(timeout) + ". " + whatToCheck(),
                                       {}});
  }
  auto reasons = reasonsIn(answer->message);
  if (answer->status != response_t::STATUS_OK) {
    const bool refused = answer->status == response_t::STATUS_REFUSED;
    return tl::unexpected(RequestError{refused ? RequestError::Kind::kRefused : RequestError::Kind::kFailed,
                                       operation + (refused ? " refused: " : " failed: ") + answer->message,
                                       std::move(reasons)});
  }
  Response response{answer->message, std::move(reasons), {}};
  for (const auto& value : answer->values) response.values[value.name] = value.value;
  return response;
}

std::vector<MotorReason> RobotSession::reasonsIn(const std::string& message) {
  const auto known = state();
  return motorReasons(message, [&](std::string_view name) { return known && known->find(name) != nullptr; });
}

RequestResult RobotSession::enable(const std::vector<std::string>& motors, Duration timeout) {
  {
    // Before it is known to have worked: one motor too many to disable on leaving does no harm.
    const Lock lock(mutex_);
    if (motors.empty()) enabled_all_ = true;
    enabled_.insert(motors.begin(), motors.end());
  }
  auto answer = request("enable", motors, {}, timeout);
  // The next state may have been taken before.
  if (answer || answer.error().kind == RequestError::Kind::kFailed) {
    Lock lock(mutex_);
    (void)changed_.wait_for(lock, kShown, [this] { return states_received_ >= states_at_answer_ + 2; });
  }
  return answer;
}

RequestResult RobotSession::disable(const std::vector<std::string>& motors, Duration timeout) {
  {
    const Lock lock(mutex_);
    for (const auto& motor : motors) held_.release(motor);
    if (motors.empty()) held_.releaseAll();
  }
  auto answer = request("disable", motors, {}, timeout);
  if (answer) {
    const Lock lock(mutex_);
    if (motors.empty()) {
      enabled_.clear();
      enabled_all_ = false;
    }
    for (const auto& motor : motors) enabled_.erase(motor);
  }
  return answer;
}

Result<void> RobotSession::estop(Duration timeout) {
  if (!status_) return status_;
  Lock lock(mutex_);
  held_.releaseAll();
  const auto seq = estop_seq_.value_or(seq_ + 1);
  seq_ = std::max(seq_, seq);
  estop_seq_ = seq;
  next_estop_ = timeNow() + kRepeatEstop;
  auto sent = publishRequest(seq, "estop", "", {});
  wake_sender_.notify_all();
  if (!sent) return sent;
  if (link_.inHandler()) return {};
  if (changed_.wait_until(lock, timeNow() + timeout, [&] { return estop_seq_ != seq; })) return {};
  lock.unlock();
  return fail("the state of robot '" + name_ + "' does not show ESTOP after " + inMs(timeout) +
              ": use the hardware emergency stop. " + whatToCheck());
}

// ---- leaving
// -----------------------------------------------------------------------------------------------

Result<void> RobotSession::close() {
  News news;
  MotorSetpoints coast;
  std::vector<std::string> disable;
  bool disable_all = false;
  {
    const Lock lock(mutex_);
    if (closed_) return {};
    closed_ = true;
    held_.releaseAll();
    while (!moves_.empty()) {
      finish(moves_.size() - 1, moves_.back().watch.failed("the program has let go of the robot"), news);
    }
    // rc10d refuses a whole message for one motor that it no longer has.
    const auto known = [&](const std::string& motor) { return state_ && state_->find(motor) != nullptr; };
    for (const auto& motor : commanded_) {
      if (known(motor)) coast.push_back({motor, Setpoint::coast()});
    }
    for (const auto& motor : enabled_) {
      if (known(motor)) disable.push_back(motor);
    }
    disable_all = enabled_all_;
    // Torque first: that needs no answer.
    if (!coast.empty()) (void)publishCommand(coast, options_.validity);
  }
  wake_sender_.notify_all();
  if (sender_.joinable()) sender_.join();
  tell(std::move(news));
  Result<void> done;
  if (disable_all || !disable.empty()) {
    const auto answer = request("disable", disable_all ? "" : joined(disable), {}, kRelease);
    if (!answer) done = fail("motors may still be enabled: " + answer.error().message);
  }
  subscriptions_.clear();
  return done;
}

}  // namespace robot_client
}  // namespace rc10
