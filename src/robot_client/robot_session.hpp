#pragma once

#include <condition_variable>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "rc10/response_t.hpp"
#include "rc10/robot.hpp"
#include "robot_client/held_targets.hpp"
#include "robot_client/host_clock.hpp"
#include "robot_client/module_inbox.hpp"
#include "robot_client/move_watch.hpp"

namespace rc10 {
inline namespace robot_client {

/// Implementation of Robot and its Motors: the state, held targets, moves and requests under one mutex, and
/// the thread that sends again. Callbacks, promises and problem texts leave outside of the mutex.
class RobotSession {
 public:
  RobotSession(std::string name, const Link& link, RobotOptions options);
  RobotSession(const RobotSession&) = delete;
  RobotSession& operator=(const RobotSession&) = delete;
  ~RobotSession();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const Link& link() const noexcept { return link_; }
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
  RequestResult request(const std::string& operation, const std::vector<std::string>& motors,
                        const std::map<std::string, double>& values, Duration timeout);
  RequestResult request(const std::string& operation, const std::string& target,
                        const std::map<std::string, double>& values, Duration timeout);
  Result<void> estop(Duration timeout);
  Result<void> close();

 private:
  using Lock = std::unique_lock<std::mutex>;

  struct Move {
    MoveWatch watch;
    std::promise<MoveResult> promise;
  };
  /// Notifications that leave after the mutex is released.
  struct News {
    std::vector<std::pair<std::promise<MoveResult>, MoveResult>> results;
    std::vector<std::string> problems;
  };

  [[nodiscard]] Result<void> checkOptions() const;
  [[nodiscard]] std::string channel(const std::string& kind) const { return name_ + ".v1." + kind; }
  [[nodiscard]] const ModuleInbox& inboxOf(const std::string& module);

  void receiveState(std::span<const std::byte> bytes);
  void receiveEvent(std::span<const std::byte> bytes);
  void receiveResponse(std::span<const std::byte> bytes);
  void foreign(const std::string& channel);

  // With the mutex held.
  [[nodiscard]] Result<void> mayCommand(const MotorSetpoints& setpoints, MonotonicTime now) const;
  Result<void> publishCommand(const MotorSetpoints& setpoints, std::chrono::milliseconds validity);
  Result<void> publishRequest(std::int64_t seq, const std::string& operation, const std::string& target,
                              const std::map<std::string, double>& values);
  void supersede(const MotorSetpoints& setpoints, News& news);
  void finish(std::size_t move, MoveResult result, News& news);
  void drop(const std::vector<HeldTargets::Dropped>& dropped, News& news);
  void resend(MonotonicTime now, News& news);
  [[nodiscard]] MonotonicTime nextWake(MonotonicTime now) const;

  void sendLoop();
  void tell(News&& news);
  void report(const std::string& problem);
  [[nodiscard]] std::string whatToCheck();
  [[nodiscard]] std::vector<MotorReason> reasonsIn(const std::string& message);

  const std::string name_;
  const Link link_;
  RobotOptions options_;
  const std::int64_t session_;
  const Result<void> status_;

  std::mutex mutex_;
  std::condition_variable changed_;      ///< A state or an answer has come.
  std::condition_variable wake_sender_;  ///< There is something to send again.
  bool closed_ = false;
  std::int64_t seq_ = 0;
  HostClock clock_;
  std::shared_ptr<const RobotState> state_;
  std::uint64_t states_received_ = 0;
  std::uint64_t states_at_answer_ = 0;  ///< states_received_ when the last answer came.
  MonotonicTime last_state_{};
  HeldTargets held_;
  std::vector<Move> moves_;
  std::map<std::int64_t, std::optional<response_t>> open_;  ///< Requests by number, and their answers.
  std::optional<std::int64_t> estop_seq_;                   ///< While the state does not show the e-stop.
  MonotonicTime next_estop_{};
  std::set<std::string> commanded_;
  std::set<std::string> enabled_;  ///< To be disabled on leaving.
  bool enabled_all_ = false;
  std::set<std::string> foreign_;  ///< Channels with other definitions.
  std::shared_ptr<std::function<void(const RobotState&)>> on_state_;
  std::shared_ptr<std::function<void(const Event&)>> on_event_;
  std::map<std::string, MonotonicTime> reported_;
  // An entry stays where it is as long as the session: it is used outside of the mutex.
  std::map<std::string, std::unique_ptr<const ModuleInbox>> modules_;

  std::thread sender_;
  // Last: they end first, and nothing is received while the rest goes.
  std::vector<Subscription> subscriptions_;
};

}  // namespace robot_client
}  // namespace rc10
