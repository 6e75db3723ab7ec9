#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "rc10/robot.hpp"
#include "robot_client/session/just_enabled.hpp"
#include "robot_client/session/leaving.hpp"
#include "robot_client/session/newest_state.hpp"
#include "robot_client/session/outgoing.hpp"
#include "robot_client/session/problems.hpp"

namespace rc10 {
inline namespace robot_client {

/// Common to the parts of a session: who talks to which robot, its newest state, and the one mutex of all.
struct SessionCore {
  using Lock = std::unique_lock<std::mutex>;

  SessionCore(std::string robot, const LcmLink& to, RobotOptions given);

  /// Receiving is on the thread of callbacks: a call that waits for a message is refused there.
  [[nodiscard]] Result<void> mayWait(const std::string& call) const;
  [[nodiscard]] Result<void> waitForState(Duration timeout);
  [[nodiscard]] std::shared_ptr<const RobotState> state();
  /// Messages with other definitions came on this channel.
  void foreign(const std::string& channel);
  /// Advice to a caller that has waited in vain.
  [[nodiscard]] std::string whatToCheck();

  /// With the mutex held: the newest state, with what enabling has changed since.
  [[nodiscard]] std::shared_ptr<const RobotState> believed() const {
    return just_enabled.corrected(newest.get(), newest.received());
  }

  const std::string name;
  const LcmLink link;
  const Result<void> status;
  const RobotOptions options;
  Problems problems;

  std::mutex mutex;
  std::condition_variable changed;      ///< A state or an answer has come.
  std::condition_variable wake_sender;  ///< There is something to send again.
  bool closed = false;
  Outgoing outgoing;
  NewestState newest;
  JustEnabled just_enabled;
  Leaving leaving;
  std::set<std::string> foreign_channels;
};

/// "500 ms"
[[nodiscard]] std::string inMs(Duration duration);

}  // namespace robot_client
}  // namespace rc10
