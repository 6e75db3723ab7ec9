#pragma once

#include <string>
#include <vector>

#include "app/time.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/clients/command_budget.hpp"
#include "daemon/clients/session_numbers.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/robot_description.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Checks messages for modules before they reach the scheduler, by the rules of Admission. Link thread only;
/// the time is an argument.
class SignalAdmission {
 public:
  /// The robot outlives it.
  explicit SignalAdmission(const RobotDescription& robot, Permissions permissions = {});

  /// Translates a message; on refusal `out` is unspecified. `now` is CLOCK_MONOTONIC.
  [[nodiscard]] CommandRefusal admit(const link::Signals& message, const Speaker& speaker, MonotonicTime now,
                                     SignalMessage& out);

  /// After kNotPermitted, why.
  [[nodiscard]] const std::string& whyNotPermitted() const noexcept { return not_permitted_; }
  /// After kExpired: the message is the newest of its session, and ends what that has sent before.
  [[nodiscard]] bool lateButNew() const noexcept { return late_but_new_; }

 private:
  const RobotDescription& robot_;
  Permissions permissions_;
  std::string not_permitted_;
  bool late_but_new_ = false;
  std::vector<SessionNumbers> sessions_;  // of each module
  CommandBudget budget_;                  // of messages, whose ring is as large as that of commands
};

}  // namespace rc10
