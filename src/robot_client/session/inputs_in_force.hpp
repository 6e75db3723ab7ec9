#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "app/time.hpp"
#include "rc10/module.hpp"
#include "rc10/robot_state.hpp"

namespace rc10 {
inline namespace robot_client {

/// The last inputs of each module, until they lapse. Pure: the time is an argument.
class InputsInForce {
 public:
  struct Given {
    Signals inputs;
    SendOptions options;
  };

  void give(const std::string& module, const Signals& inputs, const SendOptions& options, MonotonicTime now);
  /// A motor begins to be enabled: inputs from before do not move it, whichever module's it is, and would if
  /// they were said again.
  void onEvent(const Event& event);
  [[nodiscard]] std::vector<std::string> modules() const;
  /// State of `module`, received since: another client has it, or nobody, and said again they would take it.
  void onState(const std::string& module, const ModuleState& state, std::string_view client);
  /// Gives up all of them. Returns what still acts, by module, with the options that end it.
  [[nodiscard]] std::map<std::string, Given> takeAll(MonotonicTime now);

 private:
  struct Timed {
    Given given;
    MonotonicTime given_at;
    MonotonicTime until;
  };

  std::map<std::string, Timed> by_module_;
};

}  // namespace robot_client
}  // namespace rc10
