#include "robot_client/robot_session.hpp"

#include <pthread.h>

#include <algorithm>

#include "app/nearest.hpp"
#include "robot_client/convert.hpp"
#include "robot_client/event_codes.hpp"
#include "robot_client/motor_reasons.hpp"
#include "robot_client/names_heard.hpp"
#include "robot_client/obstacle.hpp"
#include "robot_client/session_options.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using std::chrono::milliseconds;

// A request or its answer can be lost: LCM is UDP. rc10d knows a repeated one again.
constexpr Duration kRepeatRequest = milliseconds{100};
// For two states after an answer: the slowest state_hz is one a second.
constexpr Duration kShown = milliseconds{2500};
constexpr Duration kRelease = milliseconds{500};
constexpr Duration kListen = milliseconds{300};

[[nodiscard]] std::string inMs(Duration duration) {
  return std::to_string(std::chrono::duration_cast<milliseconds>(duration).count()) + " ms";
}

[[nodiscard]] tl::unexpected<RequestError> notSent(std::string message) {
  return tl::unexpected(RequestError{RequestError::Kind::kNotSent, std::move(message), {}});
}

}  // namespace

RobotSession::RobotSession(std::string name, const LcmLink& link, RobotOptions options)
    : name_(std::move(name)),
      link_(link),
      status_(checkSession(name_, options).and_then([&] { return link_.status(); })),
      options_(withClient(std::move(options))),
      problems_(name_, options_.on_problem),
      outgoing_(link_, name_, options_.client, options_.priority),
      held_(options_.resend, options_.alive_within) {
  if (!status_) return;
  const auto listen = [this](const char* kind, auto receive) {
    subscriptions_.push_back(
        link_.subscribe(outgoing_.channel(kind), [this, receive](auto bytes) { (this->*receive)(bytes); }));
  };
  listen("state", &RobotSession::receiveState);
  listen("event", &RobotSession::receiveEvent);
  listen("response", &RobotSession::receiveResponse);
  sender_ = std::thread([this] { sendLoop(); });
  pthread_setname_np(sender_.native_handle(), "rc10-hold");
}

RobotSession::~RobotSession() {
  if (const auto closed = close(); !closed)
    problems_.tell("leaving " + name_ + ": " + closed.error().message);
}

// ---- receiving, on the link's thread -------------------------------------------------------------------

void RobotSession::receiveState(std::span<const std::byte> bytes) {
  robot_state_t message;
  if (!LcmLink::decode(bytes, message)) return foreign(outgoing_.channel("state"));
  const auto now = timeNow();
  auto state = std::make_shared<RobotState>(fromLcm(message));
  std::shared_ptr<std::function<void(const RobotState&)>> callback;
  News news;
  {
    const Lock lock(mutex_);
    if (closed_) return;
    if (!newest_.take(state, now)) return;
    if (state->status == RobotStatus::kEstop) estop_.shown();
    const auto judged = just_enabled_.corrected(state, newest_.received());
    moves_.onState(*judged, now, news.moves);
    drop(held_.judge(*judged, options_.client), news);
    callback = on_state_;
  }
  changed_.notify_all();
  tell(std::move(news));
  if (callback && *callback) (*callback)(*state);
}

void RobotSession::receiveEvent(std::span<const std::byte> bytes) {
  event_t message;
  if (!LcmLink::decode(bytes, message)) return foreign(outgoing_.channel("event"));
  const auto event = fromLcm(message);
  std::shared_ptr<std::function<void(const Event&)>> callback;
  bool concerns_us = event.code == kOtherDefinitions;
  {
    const Lock lock(mutex_);
    if (closed_) return;
    moves_.onEvent(event);
    const bool names_us = event.text.find('\'' + options_.client + '\'') != std::string::npos;
    concerns_us = concerns_us || (event.code == kSetpointSkipped && held_.holds(event.source)) ||
                  (names_us && (event.code == kNotOwner || event.code == kCommandRefused));
    callback = on_event_;
  }
  if (concerns_us) problems_.tell("rc10d says: " + event.source + ": " + event.text);
  if (callback && *callback) (*callback)(event);
}

void RobotSession::receiveResponse(std::span<const std::byte> bytes) {
  response_t message;
  if (!LcmLink::decode(bytes, message)) return foreign(outgoing_.channel("response"));
  // All clients of the robot hear all answers.
  if (message.session != outgoing_.session() || message.client != options_.client) return;
  {
    const Lock lock(mutex_);
    if (!requests_.take(std::move(message))) return;
    states_at_answer_ = newest_.received();
  }
  changed_.notify_all();
}

void RobotSession::foreign(const std::string& channel) {
  {
    const Lock lock(mutex_);
    if (!foreign_.insert(channel).second) return;
  }
  problems_.tell(channel +
                 " carries messages with other definitions than this program's: build it with the rc10 that "
                 "belongs to this rc10d");
}

// ---- commanding ------------------------------------------------------------------------------------------

Result<void> RobotSession::mayCommand(const MotorSetpoints& setpoints, MonotonicTime now) const {
  if (closed_) return fail("the robot is closed");
  if (!newest_.get()) {
    return fail("no state of robot '" + name_ +
                "' has come yet: call waitForState(), which says what to check");
  }
  if (!newest_.live(now)) {
    return fail("no state of robot '" + name_ + "' for a second: rc10d or rc10-lcm has ended, or hangs");
  }
  return checkSetpoints(*just_enabled_.corrected(newest_.get(), newest_.received()), setpoints);
}

Result<void> RobotSession::publishCommand(const MotorSetpoints& setpoints) {
  for (const auto& order : setpoints) leaving_.commanded.insert(order.motor);
  return outgoing_.command(setpoints, options_.validity);
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
      moves_.supersede(setpoints, news.moves);
      done = publishCommand(setpoints);
      if (options_.resend != milliseconds{0}) held_.set(setpoints, now);
    }
  }
  wake_sender_.notify_all();
  tell(std::move(news));
  if (!done) problems_.tell(done.error().message);
  return done;
}

std::future<MoveResult> RobotSession::moveTo(const MoveGoal& goal) {
  const MotorSetpoints setpoints{{goal.motor, goal.mode == Mode::kAngle
                                                  ? Setpoint::angle(Degrees{goal.target_deg})
                                                  : Setpoint::totalAngle(Degrees{goal.target_deg})}};
  const auto now = timeNow();
  MoveWatch watch(goal, options_.client, now);
  std::promise<MoveResult> promise;
  auto future = promise.get_future();
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
      moves_.supersede(setpoints, news.moves);
      possible = publishCommand(setpoints);
    }
    if (possible) {
      held_.set(setpoints, now);
      moves_.start(std::move(watch), std::move(promise));
    } else {
      news.moves.push_back({std::move(promise), watch.failed(possible.error().message)});
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

void RobotSession::drop(const std::vector<HeldTargets::Dropped>& dropped, News& news) {
  for (const auto& [motor, reason] : dropped) {
    news.problems.push_back("target dropped: " + reason);
    moves_.fail(motor, reason, news.moves);
  }
}

// ---- modules ---------------------------------------------------------------------------------------------

const ModuleInbox& RobotSession::inboxOf(const std::string& module) {
  return inboxes_.of(link_, outgoing_.channel(module));
}

Result<void> RobotSession::send(const std::string& module, const Signals& inputs,
                                const SendOptions& options) {
  if (!status_) return status_;
  auto done = checkInputs(module, inputs, options);
  bool missing = false;
  if (done) {
    const bool heard = inboxOf(module).heard();
    // Sent under the mutex: another thread's message with a higher number must not overtake it.
    const Lock lock(mutex_);
    const auto now = timeNow();
    held_.alive(now);
    done = closed_ ? fail("the robot is closed") : outgoing_.inputs(module, inputs, options);
    missing = done && silent_.sent(module, heard, newest_.live(now), now);
  }
  if (missing)
    problems_.tell("robot '" + name_ + "' is heard, and nothing of module '" + module +
                   "' to which inputs are sent: `rc10ctl modules` shows which there are");
  if (!done) problems_.tell(done.error().message);
  return done;
}

ModuleState RobotSession::moduleState(const std::string& module) { return inboxOf(module).state(); }

double RobotSession::moduleOutput(const std::string& module, std::string_view output) {
  const auto state = moduleState(module);
  if (state && state.outputs.find(output) == state.outputs.end()) {
    std::vector<std::string_view> names;
    for (const auto& [name, value] : state.outputs) names.emplace_back(name);
    problems_.tell(module + " has no output '" + std::string(output) + "'; there are " + state.outputNames() +
                   didYouMean(output, names));
  }
  return state[output];
}

Result<void> RobotSession::waitForModule(const std::string& module, Duration timeout) {
  if (auto may = mayWait(module + ".waitForState()"); !may) return may;
  const auto& inbox = inboxOf(module);
  NamesHeard modules(link_, outgoing_.channel(""), ".state");
  if (inbox.waitForNext(timeout)) return {};
  if (inbox.foreign()) foreign(outgoing_.channel(module) + ".state");
  if (const auto names = modules.names(kListen); !names.empty() && names.count(module) == 0) {
    return fail("nothing of module '" + module + "' within " + inMs(timeout) + ". Heard here: module " +
                listOf(names) + didYouMean(module, {names.begin(), names.end()}));
  }
  return fail("nothing of module '" + module + "' within " + inMs(timeout) +
              ": `rc10ctl modules` shows which there are. " + whatToCheck());
}

// ---- sending again ---------------------------------------------------------------------------------------

void RobotSession::resend(MonotonicTime now, News& news) {
  drop(held_.lapse(now), news);
  if (newest_.get() && !newest_.live(now) && !held_.motors().empty()) {
    std::vector<HeldTargets::Dropped> dropped;
    for (const auto& motor : held_.motors()) dropped.push_back({motor, motor + ": no state for a second"});
    held_.releaseAll();
    drop(dropped, news);
  }
  moves_.onTime(now, news.moves);
  for (const auto& message : held_.takeDue(now)) (void)publishCommand(message);
  if (const auto number = estop_.due(now)) {
    (void)outgoing_.request(*number, toString(Operation::kEstop), "", {});
    estop_.sent(*number, now);
  }
}

MonotonicTime RobotSession::nextWake(MonotonicTime now) const {
  auto next = now + std::chrono::hours{1};
  for (const auto due : {held_.nextDue(), estop_.nextDue(), moves_.nextLook(now)}) {
    if (due) next = std::min(next, *due);
  }
  return next;
}

void RobotSession::sendLoop() {
  Lock lock(mutex_);
  while (!closed_) {
    const auto now = timeNow();
    News news;
    resend(now, news);
    if (!news.moves.empty() || !news.problems.empty()) {
      lock.unlock();
      tell(std::move(news));
      lock.lock();
      continue;
    }
    wake_sender_.wait_until(lock, nextWake(now));
  }
}

void RobotSession::tell(News&& news) {
  for (auto& move : news.moves) move.tell();
  for (const auto& problem : news.problems) problems_.tell(problem);
}

Result<void> RobotSession::mayWait(const std::string& call) const {
  if (!status_) return status_;
  if (link_.inHandler()) return fail(call + " in a callback would wait for itself");
  return {};
}

// ---- states ----------------------------------------------------------------------------------------------

Result<void> RobotSession::waitForState(Duration timeout) {
  if (auto may = mayWait("waitForState()"); !may) return may;
  {
    Lock lock(mutex_);
    const auto known = newest_.received();
    if (changed_.wait_for(lock, timeout, [&] { return newest_.received() > known; })) return {};
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
    if (newest_.live(timeNow())) {
      return "Its state arrives, so rc10d runs and is heard: see rc10d's log for the reason.";
    }
  }
  if (const auto names = NamesHeard(link_, "", ".v1.state").names(kListen); !names.empty()) {
    return "Heard here: robot " + listOf(names) + ": is the name right?";
  }
  return "Check: is rc10d running (rc10ctl list)? Is its robot called '" + name_ +
         "' (robot: in its configuration)? Does multicast stay on this computer: 'ip route get "
         "239.255.76.67' "
         "must say 'dev lo', else run: sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1";
}

std::shared_ptr<const RobotState> RobotSession::state() {
  const Lock lock(mutex_);
  return newest_.get();
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

// ---- requests --------------------------------------------------------------------------------------------

RequestResult RobotSession::request(Operation operation, const std::vector<std::string>& motors,
                                    const std::map<std::string, double>& values, Duration timeout) {
  for (const auto& name : motors) {
    // An empty name would be understood as "all", a comma as two names.
    if (name.empty() || name.find(',') != std::string::npos)
      return notSent("'" + name + "' is no motor's name");
    const auto known = state();
    if (known && known->find(name) == nullptr) {
      return notSent(noMotor(*known, name));
    }
  }
  return request(toString(operation), joined(motors), values, timeout);
}

RequestResult RobotSession::request(const std::string& operation, const std::string& target,
                                    const std::map<std::string, double>& values, Duration timeout) {
  if (auto may = mayWait(operation); !may) return notSent(may.error().message);
  const auto deadline = timeNow() + timeout;
  std::optional<response_t> answer;
  {
    Lock lock(mutex_);
    const auto number = outgoing_.nextNumber();
    requests_.open(number);
    for (auto now = timeNow(); now < deadline && !answer; now = timeNow()) {
      if (auto sent = outgoing_.request(number, operation, target, values); !sent) {
        requests_.close(number);
        return notSent(sent.error().message);
      }
      changed_.wait_until(lock, std::min(deadline, now + kRepeatRequest),
                          [&] { return requests_.answer(number).has_value(); });
      answer = requests_.answer(number);
    }
    requests_.close(number);
  }
  if (!answer) {
    return tl::unexpected(RequestError{RequestError::Kind::kNoAnswer,
                                       "no answer to '" + operation + "' from robot '" + name_ + "' within " +
                                           inMs(timeout) + ". " + whatToCheck(),
                                       {}});
  }
  return requestResult(operation, *answer, reasonsIn(answer->message));
}

std::vector<MotorReason> RobotSession::reasonsIn(const std::string& message) {
  const auto known = state();
  return motorReasons(message, [&](std::string_view name) { return known && known->find(name) != nullptr; });
}

RequestResult RobotSession::enable(const std::vector<std::string>& motors, Duration timeout) {
  {
    // Noted before the answer: to disable one motor too many on leaving does no harm.
    const Lock lock(mutex_);
    if (motors.empty()) leaving_.enabled_all = true;
    leaving_.enabled.insert(motors.begin(), motors.end());
  }
  auto answer = request(Operation::kEnable, motors, {}, timeout);
  // A failure may concern some of them only.
  if (answer || answer.error().kind == RequestError::Kind::kFailed) {
    Lock lock(mutex_);
    noteEnabled(motors);
    (void)changed_.wait_for(lock, kShown, [&] { return showsEnabled(motors); });
  }
  return answer;
}

void RobotSession::noteEnabled(const std::vector<std::string>& motors) {
  std::vector<std::string> names = motors;
  if (names.empty() && newest_.get()) {
    for (const auto& motor : newest_.get()->motors) names.push_back(motor.name);
  }
  just_enabled_.answered(names, states_at_answer_);
}

// Each of them is ACTIVE, or what else the newest state says of it is news.
bool RobotSession::showsEnabled(const std::vector<std::string>& motors) const {
  const auto& state = newest_.get();
  if (newest_.received() > states_at_answer_ + JustEnabled::kMayBeOlder) return true;
  return state && std::all_of(state->motors.begin(), state->motors.end(), [&](const MotorState& motor) {
           const bool meant =
               motors.empty() || std::find(motors.begin(), motors.end(), motor.name) != motors.end();
           return !meant || motor.status == MotorStatus::kActive;
         });
}

RequestResult RobotSession::disable(const std::vector<std::string>& motors, Duration timeout) {
  {
    const Lock lock(mutex_);
    for (const auto& motor : motors) {
      held_.release(motor);
      just_enabled_.release(motor);
    }
    if (motors.empty()) {
      held_.releaseAll();
      just_enabled_.releaseAll();
    }
  }
  auto answer = request(Operation::kDisable, motors, {}, timeout);
  if (answer) {
    const Lock lock(mutex_);
    if (motors.empty()) {
      leaving_.enabled.clear();
      leaving_.enabled_all = false;
    }
    for (const auto& motor : motors) leaving_.enabled.erase(motor);
  }
  return answer;
}

Result<void> RobotSession::estop(Duration timeout) {
  if (!status_) return status_;
  Lock lock(mutex_);
  held_.releaseAll();
  const auto under_way = estop_.number();
  const auto number = under_way ? *under_way : outgoing_.nextNumber();
  estop_.sent(number, timeNow());
  auto sent = outgoing_.request(number, toString(Operation::kEstop), "", {});
  wake_sender_.notify_all();
  if (!sent) return sent;
  if (link_.inHandler()) return {};
  if (changed_.wait_until(lock, timeNow() + timeout, [&] { return estop_.number() != number; })) return {};
  lock.unlock();
  return fail("the state of robot '" + name_ + "' does not show ESTOP after " + inMs(timeout) +
              ": use the hardware emergency stop. " + whatToCheck());
}

// ---- leaving ---------------------------------------------------------------------------------------------

Result<void> RobotSession::close() {
  News news;
  MotorSetpoints coast;
  std::vector<std::string> disable;
  bool disable_all = false;
  {
    const Lock lock(mutex_);
    if (closed_) return {};
    closed_ = true;
    const auto held = held_.takeAll();
    moves_.failAll("the program has let go of the robot", news.moves);
    if (options_.at_end == AtEnd::kTimeout) {
      // The same targets, not COAST: rc10d does on_timeout after a target that lapses, nothing after a COAST.
      for (const auto& message : held) (void)outgoing_.command(message, milliseconds{1});
      leaving_ = {};
    }
    // rc10d refuses a whole message for one motor that it no longer has.
    const auto& state = newest_.get();
    const auto known = [&](const std::string& motor) { return state && state->find(motor) != nullptr; };
    for (const auto& motor : leaving_.commanded) {
      if (known(motor)) coast.push_back({motor, Setpoint::coast()});
    }
    for (const auto& motor : leaving_.enabled) {
      if (known(motor)) disable.push_back(motor);
    }
    disable_all = leaving_.enabled_all;
    // Torque first: that needs no answer.
    if (options_.at_end == AtEnd::kCoast && !coast.empty()) (void)publishCommand(coast);
  }
  wake_sender_.notify_all();
  if (sender_.joinable()) sender_.join();
  tell(std::move(news));
  Result<void> done;
  if (disable_all || !disable.empty()) {
    const auto answer =
        request(toString(Operation::kDisable), disable_all ? "" : joined(disable), {}, kRelease);
    if (!answer) done = fail("motors may still be enabled: " + answer.error().message);
  }
  subscriptions_.clear();
  return done;
}

}  // namespace robot_client
}  // namespace rc10
