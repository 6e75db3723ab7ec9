#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rc10/robot_state.hpp"
#include "rc10/setpoint.hpp"

namespace rc10 {
inline namespace robot_client {

/// Motors that a program has commanded or enabled, to be let go of when it leaves. Pure.
class Leaving {
 public:
  void commanded(const MotorSetpoints& setpoints);
  /// Without names: all, here and below.
  void enabled(const std::vector<std::string>& motors);
  void disabled(const std::vector<std::string>& motors);
  void forget() { *this = {}; }
  [[nodiscard]] bool disables(const std::string& motor) const {
    return enabled_all_ || enabled_.contains(motor);
  }

  // Motors that are not in the state are left out: rc10d refuses a whole message for one that it no longer
  // has.
  /// COAST for all that was commanded.
  [[nodiscard]] MotorSetpoints coasts(const RobotState* state) const;
  /// Target of the request that disables what was enabled; none where nothing was.
  [[nodiscard]] std::optional<std::string> toDisable(const RobotState* state) const;

 private:
  std::set<std::string> commanded_;
  std::set<std::string> enabled_;
  bool enabled_all_ = false;
};

}  // namespace robot_client
}  // namespace rc10
