#include "robot_client/session/session_requests.hpp"

#include <algorithm>
#include <sstream>

#include "robot_client/session/motor_reasons.hpp"
#include "robot_client/session/obstacle.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using std::chrono::milliseconds;
using Lock = SessionCore::Lock;

// A request or its answer can be lost: LCM is UDP. rc10d knows a repeated one again.
constexpr Duration kRepeatRequest = milliseconds{100};
// For two states after an answer: the slowest state_hz is one a second.
constexpr Duration kShown = milliseconds{2500};

[[nodiscard]] tl::unexpected<RequestError> notSent(std::string message) {
  return tl::unexpected(RequestError{RequestError::Kind::kNotSent, std::move(message), {}});
}

}  // namespace

RequestResult SessionRequests::request(Operation operation, const std::vector<std::string>& motors,
                                       const std::map<std::string, double>& values, Duration timeout) {
  for (const auto& name : motors) {
    // An empty name would be understood as "all", a comma as two names.
    if (name.empty() || name.find(',') != std::string::npos)
      return notSent("'" + name + "' is no motor's name");
    const auto known = core_.state();
    if (known && known->find(name) == nullptr) {
      return notSent(noMotor(*known, name));
    }
  }
  return request(toString(operation), joined(motors), values, timeout);
}

RequestResult SessionRequests::request(const std::string& operation, const std::string& target,
                                       const std::map<std::string, double>& values, Duration timeout) {
  releaseBefore(operation, target);
  if (auto may = core_.mayWait(operation); !may) return notSent(may.error().message);
  const auto deadline = timeNow() + timeout;
  std::optional<response_t> answer;
  {
    Lock lock(core_.mutex);
    const auto number = core_.outgoing.nextNumber();
    open_.open(number);
    for (auto now = timeNow(); now < deadline && !answer; now = timeNow()) {
      if (auto sent = core_.outgoing.request(number, operation, target, values); !sent) {
        open_.close(number);
        return notSent(sent.error().message);
      }
      core_.changed.wait_until(lock, std::min(deadline, now + kRepeatRequest),
                               [&] { return open_.answer(number).has_value(); });
      answer = open_.answer(number);
    }
    open_.close(number);
  }
  if (!answer) {
    return tl::unexpected(RequestError{RequestError::Kind::kNoAnswer,
                                       "no answer to '" + operation + "' from robot '" + core_.name +
                                           "' within " + inMs(timeout) + ". " + core_.whatToCheck(),
                                       {}});
  }
  return requestResult(operation, *answer, reasonsIn(answer->message));
}

std::vector<MotorReason> SessionRequests::reasonsIn(const std::string& message) {
  const auto known = core_.state();
  return motorReasons(message, [&](std::string_view name) { return known && known->find(name) != nullptr; });
}

RequestResult SessionRequests::enable(const std::vector<std::string>& motors, Duration timeout) {
  {
    // Noted before the answer: to disable one motor too many on leaving does no harm.
    const Lock lock(core_.mutex);
    core_.leaving.enabled(motors);
  }
  auto answer = request(Operation::kEnable, motors, {}, timeout);
  // A failure may concern some of them only.
  if (answer || answer.error().kind == RequestError::Kind::kFailed) {
    Lock lock(core_.mutex);
    noteEnabled(motors);
    (void)core_.changed.wait_for(lock, kShown, [&] { return showsEnabled(motors); });
  }
  return answer;
}

void SessionRequests::noteEnabled(const std::vector<std::string>& motors) {
  std::vector<std::string> names = motors;
  if (names.empty() && core_.newest.get()) {
    for (const auto& motor : core_.newest.get()->motors) names.push_back(motor.name);
  }
  core_.just_enabled.answered(names, states_at_answer_);
}

// Each of them is ACTIVE, or what else the newest state says of it is news.
bool SessionRequests::showsEnabled(const std::vector<std::string>& motors) const {
  const auto& state = core_.newest.get();
  if (core_.newest.received() > states_at_answer_ + JustEnabled::kMayBeOlder) return true;
  return state && std::all_of(state->motors.begin(), state->motors.end(), [&](const MotorState& motor) {
           const bool meant =
               motors.empty() || std::find(motors.begin(), motors.end(), motor.name) != motors.end();
           return !meant || motor.status == MotorStatus::kActive;
         });
}

RequestResult SessionRequests::disable(const std::vector<std::string>& motors, Duration timeout) {
  release(motors);  // also where a name is wrong, and nothing is sent
  auto answer = request(Operation::kDisable, motors, {}, timeout);
  if (answer) {
    const Lock lock(core_.mutex);
    core_.leaving.disabled(motors);
  }
  return answer;
}

void SessionRequests::release(const std::vector<std::string>& motors) {
  const Lock lock(core_.mutex);
  targets_.release(motors);
  core_.just_enabled.release(motors);
}

// Targets of motors that are to stop are not sent again, whatever the answer will be.
void SessionRequests::releaseBefore(const std::string& operation, const std::string& target) {
  if (operation == toString(Operation::kEstop)) release({});
  if (operation != toString(Operation::kDisable)) return;
  std::vector<std::string> motors;
  std::istringstream names(target);
  for (std::string name; std::getline(names, name, ',');) motors.push_back(name);
  release(motors);
}

void SessionRequests::onResponse(response_t message) {
  if (message.session != core_.outgoing.session() || message.client != core_.options.client) return;
  {
    const Lock lock(core_.mutex);
    if (!open_.take(std::move(message))) return;
    states_at_answer_ = core_.newest.received();
  }
  core_.changed.notify_all();
}

}  // namespace robot_client
}  // namespace rc10
