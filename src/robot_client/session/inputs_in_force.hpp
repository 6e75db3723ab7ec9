#pragma once

#include <map>
#include <string>

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
  /// Gives up all of them. Returns what still acts, by module, with the options that end it.
  [[nodiscard]] std::map<std::string, Given> takeAll(MonotonicTime now);

 private:
  struct Timed {
    Given given;
    MonotonicTime until;
  };

  std::map<std::string, Timed> by_module_;
};

}  // namespace robot_client
}  // namespace rc10
