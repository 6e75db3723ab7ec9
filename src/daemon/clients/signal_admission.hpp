#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/time.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/clients/command_budget.hpp"
#include "daemon/clients/session_numbers.hpp"
#include "daemon/exchange/orders.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Module, as admission knows it.
struct KnownModule {
  std::string name;
  std::vector<std::string> inputs;
};

/// Checks messages for modules before they reach the scheduler, by the rules of Admission. Link thread only;
/// the time is an argument.
class SignalAdmission {
 public:
  explicit SignalAdmission(std::vector<KnownModule> modules, Permissions permissions = {});

  /// Translates a message; on refusal `out` is unspecified. `now` is CLOCK_MONOTONIC.
  [[nodiscard]] CommandRefusal admit(const link::Signals& message, const Speaker& speaker, MonotonicTime now,
                                     SignalMessage& out);

  /// After kNotPermitted, why.
  [[nodiscard]] const std::string& whyNotPermitted() const noexcept { return not_permitted_; }

 private:
  std::vector<KnownModule> modules_;
  Permissions permissions_;
  std::string not_permitted_;
  std::vector<SessionNumbers> sessions_;  // of each module
  CommandBudget budget_;                  // of messages, whose ring is as large as that of commands
};

}  // namespace rc10
