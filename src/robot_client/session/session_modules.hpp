#pragma once

#include <string>
#include <string_view>

#include "robot_client/session/inputs_in_force.hpp"
#include "robot_client/session/module_inbox.hpp"
#include "robot_client/session/session_core.hpp"
#include "robot_client/session/session_targets.hpp"
#include "robot_client/session/silent_modules.hpp"

namespace rc10 {
inline namespace robot_client {

/// Inputs to modules, and their states.
class SessionModules {
 public:
  SessionModules(SessionCore& core, SessionTargets& targets) : core_(core), targets_(targets) {}

  void listenTo(const std::string& module) { (void)inboxOf(module); }
  Result<void> send(const std::string& module, const Signals& inputs, const SendOptions& options);
  [[nodiscard]] ModuleState state(const std::string& module) { return inboxOf(module).state(); }
  [[nodiscard]] double output(const std::string& module, std::string_view output);
  [[nodiscard]] Result<void> waitForState(const std::string& module, Duration timeout);

  // With the mutex held.
  void onEvent(const Event& event) { in_force_.onEvent(event); }
  /// The program leaves: inputs that act end now, not when they lapse.
  void letGo(MonotonicTime now);

 private:
  [[nodiscard]] const ModuleInbox& inboxOf(const std::string& module);

  SessionCore& core_;
  SessionTargets& targets_;
  ModuleInboxes inboxes_;
  // Under the mutex:
  SilentModules silent_;
  InputsInForce in_force_;
};

}  // namespace robot_client
}  // namespace rc10
