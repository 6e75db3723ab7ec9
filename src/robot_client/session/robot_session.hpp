#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "robot_client/session/session_core.hpp"
#include "robot_client/session/session_estop.hpp"
#include "robot_client/session/session_modules.hpp"
#include "robot_client/session/session_requests.hpp"
#include "robot_client/session/session_targets.hpp"

namespace rc10 {
inline namespace robot_client {

/// Implementation of Robot, Motor and Module: the parts of a session, the messages that come to them, and the
/// thread that sends again. Callbacks, promises and problems leave outside of the mutex.
class RobotSession {
 public:
  RobotSession(std::string name, const LcmLink& link, RobotOptions options);
  RobotSession(const RobotSession&) = delete;
  RobotSession& operator=(const RobotSession&) = delete;
  ~RobotSession();

  [[nodiscard]] SessionCore& core() noexcept { return core_; }
  [[nodiscard]] SessionTargets& targets() noexcept { return targets_; }
  [[nodiscard]] SessionRequests& requests() noexcept { return requests_; }
  [[nodiscard]] SessionModules& modules() noexcept { return modules_; }

  Result<void> estop(Duration timeout) { return estop_.estop(timeout); }
  void onState(std::function<void(const RobotState&)> callback);
  void onEvent(std::function<void(const Event&)> callback);
  Result<void> close();

 private:
  void receiveState(std::span<const std::byte> bytes);
  void receiveEvent(std::span<const std::byte> bytes);
  void receiveResponse(std::span<const std::byte> bytes);

  void sendLoop();
  [[nodiscard]] MonotonicTime nextWake(MonotonicTime now) const;

  SessionCore core_;
  SessionTargets targets_{core_};
  SessionRequests requests_{core_, targets_};
  SessionModules modules_{core_, targets_};
  SessionEstop estop_{core_, targets_};
  std::shared_ptr<std::function<void(const RobotState&)>> on_state_;
  std::shared_ptr<std::function<void(const Event&)>> on_event_;

  std::thread sender_;
  // Last: they end first, and nothing is received while the rest goes.
  std::vector<Subscription> subscriptions_;
};

}  // namespace robot_client
}  // namespace rc10
