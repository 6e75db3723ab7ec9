#pragma once

#include <condition_variable>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "rc10/robot.hpp"
#include "robot_client/estop_repetition.hpp"
#include "robot_client/held_targets.hpp"
#include "robot_client/just_enabled.hpp"
#include "robot_client/module_inbox.hpp"
#include "robot_client/moves.hpp"
#include "robot_client/newest_state.hpp"
#include "robot_client/open_requests.hpp"
#include "robot_client/outgoing.hpp"
#include "robot_client/problems.hpp"
#include "robot_client/silent_modules.hpp"

namespace rc10 {
inline namespace robot_client {

/// Implementation of Robot and its Motors: its parts under one mutex, the messages that come, and the thread
/// that sends again. Callbacks, promises and problems leave outside of the mutex.
class RobotSession {
 public:
  RobotSession(std::string name, const LcmLink& link, RobotOptions options);
  RobotSession(const RobotSession&) = delete;
  RobotSession& operator=(const RobotSession&) = delete;
  ~RobotSession();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const LcmLink& link() const noexcept { return link_; }
  [[nodiscard]] const Result<void>& status() const noexcept { return status_; }

  Result<void> command(const MotorSetpoints& setpoints);
  [[nodiscard]] std::future<MoveResult> moveTo(const MoveGoal& goal);
  void alive();

  void listenTo(const std::string& module) { (void)inboxOf(module); }
  Result<void> send(const std::string& module, const Signals& inputs, const SendOptions& options);
  [[nodiscard]] ModuleState moduleState(const std::string& module);
  [[nodiscard]] double moduleOutput(const std::string& module, std::string_view output);
  [[nodiscard]] Result<void> waitForModule(const std::string& module, Duration timeout);

  Result<void> waitForState(Duration timeout);
  [[nodiscard]] std::shared_ptr<const RobotState> state();
  void onState(std::function<void(const RobotState&)> callback);
  void onEvent(std::function<void(const Event&)> callback);

  RequestResult enable(const std::vector<std::string>& motors, Duration timeout);
  RequestResult disable(const std::vector<std::string>& motors, Duration timeout);
  RequestResult request(Operation operation, const std::vector<std::string>& motors,
                        const std::map<std::string, double>& values, Duration timeout);
  RequestResult request(const std::string& operation, const std::string& target,
                        const std::map<std::string, double>& values, Duration timeout);
  Result<void> estop(Duration timeout);
  Result<void> close();

 private:
  using Lock = std::unique_lock<std::mutex>;

  /// Notifications that leave after the mutex is released.
  struct News {
    std::vector<Moves::Ended> moves;
    std::vector<std::string> problems;
  };
  /// Motors to be let go of on leaving.
  struct Leaving {
    std::set<std::string> commanded;
    std::set<std::string> enabled;
    bool enabled_all = false;
  };

  void receiveState(std::span<const std::byte> bytes);
  void receiveEvent(std::span<const std::byte> bytes);
  void receiveResponse(std::span<const std::byte> bytes);
  void foreign(const std::string& channel);

  // With the mutex held.
  [[nodiscard]] Result<void> mayCommand(const MotorSetpoints& setpoints, MonotonicTime now) const;
  Result<void> publishCommand(const MotorSetpoints& setpoints);
  void noteEnabled(const std::vector<std::string>& motors);
  [[nodiscard]] bool showsEnabled(const std::vector<std::string>& motors) const;
  void drop(const std::vector<HeldTargets::Dropped>& dropped, News& news);
  void resend(MonotonicTime now, News& news);
  [[nodiscard]] MonotonicTime nextWake(MonotonicTime now) const;

  void sendLoop();
  void tell(News&& news);
  [[nodiscard]] const ModuleInbox& inboxOf(const std::string& module);
  /// Receiving is on the thread of callbacks: a call that waits for a message is refused there.
  [[nodiscard]] Result<void> mayWait(const std::string& call) const;
  [[nodiscard]] std::string whatToCheck();
  [[nodiscard]] std::vector<MotorReason> reasonsIn(const std::string& message);

  const std::string name_;
  const LcmLink link_;
  const Result<void> status_;
  const RobotOptions options_;
  Problems problems_;
  ModuleInboxes inboxes_;

  std::mutex mutex_;
  std::condition_variable changed_;      ///< A state or an answer has come.
  std::condition_variable wake_sender_;  ///< There is something to send again.
  bool closed_ = false;
  Outgoing outgoing_;
  NewestState newest_;
  SilentModules silent_;
  std::uint64_t states_at_answer_ = 0;  ///< States received when the last answer came.
  JustEnabled just_enabled_;
  HeldTargets held_;
  Moves moves_{held_};
  OpenRequests requests_;
  EstopRepetition estop_;
  Leaving leaving_;
  std::set<std::string> foreign_;  ///< Channels with other definitions.
  std::shared_ptr<std::function<void(const RobotState&)>> on_state_;
  std::shared_ptr<std::function<void(const Event&)>> on_event_;

  std::thread sender_;
  // Last: they end first, and nothing is received while the rest goes.
  std::vector<Subscription> subscriptions_;
};

}  // namespace robot_client
}  // namespace rc10
