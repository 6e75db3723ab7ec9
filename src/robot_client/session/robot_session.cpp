#include "robot_client/session/robot_session.hpp"

#include <pthread.h>

#include <algorithm>

#include "robot_client/convert.hpp"
#include "robot_client/session/event_codes.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using Lock = SessionCore::Lock;

constexpr Duration kRelease = std::chrono::milliseconds{500};
// Value of a disable request that nobody asked for: what an e-stop holds stays held.
constexpr const char* kAtEnd = "at_end";

}  // namespace

RobotSession::RobotSession(std::string name, const LcmLink& link, RobotOptions options)
    : core_(std::move(name), link, std::move(options)) {
  if (!core_.status) return;
  const auto listen = [this](const char* kind, auto receive) {
    subscriptions_.push_back(core_.link.subscribe(core_.outgoing.channel(kind),
                                                  [this, receive](auto bytes) { (this->*receive)(bytes); }));
  };
  listen("state", &RobotSession::receiveState);
  listen("event", &RobotSession::receiveEvent);
  listen("response", &RobotSession::receiveResponse);
  sender_ = std::thread([this] { sendLoop(); });
  pthread_setname_np(sender_.native_handle(), "rc10-hold");
}

RobotSession::~RobotSession() {
  if (const auto closed = close(); !closed)
    core_.problems.tell("leaving " + core_.name + ": " + closed.error().message);
}

// ---- receiving, on the link's thread -------------------------------------------------------------------

void RobotSession::receiveState(std::span<const std::byte> bytes) {
  robot_state_t message;
  if (!LcmLink::decode(bytes, message)) return core_.foreign(core_.outgoing.channel("state"));
  const auto now = timeNow();
  auto state = std::make_shared<RobotState>(fromLcm(message));
  std::shared_ptr<std::function<void(const RobotState&)>> callback;
  News news;
  {
    const Lock lock(core_.mutex);
    if (!core_.newest.take(state, now, !core_.link.moreWaits())) return;
    // close() may wait for it.
    estop_.onState(*state);
    core_.changed.notify_all();
    if (core_.closed) return;
    targets_.onState(*core_.believed(), now, news);
    callback = on_state_;
  }
  news.tell(core_.problems);
  if (callback && *callback) (*callback)(*state);
}

void RobotSession::receiveEvent(std::span<const std::byte> bytes) {
  event_t message;
  if (!LcmLink::decode(bytes, message)) return core_.foreign(core_.outgoing.channel("event"));
  const auto event = fromLcm(message);
  std::shared_ptr<std::function<void(const Event&)>> callback;
  News news;
  bool concerns_us = event.code == kOtherDefinitions;
  {
    const Lock lock(core_.mutex);
    if (core_.closed) return;
    targets_.onEvent(event, news);
    modules_.onEvent(event);
    const bool names_us = event.text.find('\'' + core_.options.client + '\'') != std::string::npos;
    concerns_us = concerns_us || (event.code == kSetpointSkipped && targets_.holds(event.source)) ||
                  (names_us && (event.code == kNotOwner || event.code == kCommandRefused));
    callback = on_event_;
  }
  news.tell(core_.problems);
  if (concerns_us) core_.problems.tell("rc10d says: " + event.source + ": " + event.text);
  if (callback && *callback) (*callback)(event);
}

void RobotSession::receiveResponse(std::span<const std::byte> bytes) {
  response_t message;
  if (!LcmLink::decode(bytes, message)) return core_.foreign(core_.outgoing.channel("response"));
  requests_.onResponse(std::move(message));
}

void RobotSession::onState(std::function<void(const RobotState&)> callback) {
  auto shared = std::make_shared<std::function<void(const RobotState&)>>(std::move(callback));
  const Lock lock(core_.mutex);
  on_state_ = std::move(shared);
}

void RobotSession::onEvent(std::function<void(const Event&)> callback) {
  auto shared = std::make_shared<std::function<void(const Event&)>>(std::move(callback));
  const Lock lock(core_.mutex);
  on_event_ = std::move(shared);
}

// ---- sending again ---------------------------------------------------------------------------------------

void RobotSession::sendLoop() {
  Lock lock(core_.mutex);
  while (!core_.closed) {
    const auto now = timeNow();
    News news;
    targets_.sendAgain(now, news);
    estop_.sendAgain(now);
    if (!news.empty()) {
      lock.unlock();
      news.tell(core_.problems);
      lock.lock();
      continue;
    }
    core_.wake_sender.wait_until(lock, nextWake(now));
  }
}

MonotonicTime RobotSession::nextWake(MonotonicTime now) const {
  auto next = now + std::chrono::hours{1};
  for (const auto due : {targets_.nextDue(now), estop_.nextDue()}) {
    if (due) next = std::min(next, *due);
  }
  return next;
}

// ---- leaving ---------------------------------------------------------------------------------------------

Result<void> RobotSession::close() {
  News news;
  std::optional<std::string> disable;
  {
    const Lock lock(core_.mutex);
    if (core_.closed) return {};
    core_.closed = true;
    // Torque first: that needs no answer.
    targets_.letGo(timeNow(), news);
    modules_.letGo(timeNow());
    disable = core_.leaving.toDisable(core_.newest.get().get());
  }
  core_.wake_sender.notify_all();
  if (sender_.joinable()) sender_.join();
  news.tell(core_.problems);
  Result<void> done = estop_.finish(kRelease);
  if (disable) {
    const auto answer = requests_.request(toString(Operation::kDisable), *disable, {{kAtEnd, 1.0}}, kRelease);
    if (!answer) done = fail("motors may still be enabled: " + answer.error().message);
  }
  subscriptions_.clear();
  return done;
}

}  // namespace robot_client
}  // namespace rc10
