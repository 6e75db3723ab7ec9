#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "robot_client/session/open_requests.hpp"
#include "robot_client/session/session_core.hpp"
#include "robot_client/session/session_targets.hpp"

namespace rc10 {
inline namespace robot_client {

/// Requests of a program, sent again until their answers come.
class SessionRequests {
 public:
  SessionRequests(SessionCore& core, SessionTargets& targets) : core_(core), targets_(targets) {}

  RequestResult request(Operation operation, const std::vector<std::string>& motors,
                        const std::map<std::string, double>& values, Duration timeout);
  RequestResult request(const std::string& operation, const std::string& target,
                        const std::map<std::string, double>& values, Duration timeout);
  RequestResult enable(const std::vector<std::string>& motors, Duration timeout);
  RequestResult disable(const std::vector<std::string>& motors, Duration timeout);

  /// An answer to any client of the robot: all hear all.
  void onResponse(response_t message);

 private:
  void release(const std::vector<std::string>& motors);
  void releaseBefore(const std::string& operation, const std::string& target);
  [[nodiscard]] std::vector<MotorReason> reasonsIn(const std::string& message);
  // With the mutex held.
  void noteEnabled(const std::vector<std::string>& motors);
  [[nodiscard]] bool showsEnabled(const std::vector<std::string>& motors) const;

  SessionCore& core_;
  SessionTargets& targets_;
  OpenRequests open_;
  std::uint64_t states_at_answer_ = 0;  ///< States received when the last answer came.
};

}  // namespace robot_client
}  // namespace rc10
