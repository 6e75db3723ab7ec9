#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "rc10/robot_state.hpp"

namespace rc10 {
inline namespace robot_client {

/// Motors whose enabling was answered, as long as the newest state may be older than the answer: such a state
/// says nothing about them. Pure. States are counted as they are received.
class JustEnabled {
 public:
  /// `states` had been received when the answer came.
  void answered(const std::vector<std::string>& motors, std::uint64_t states);
  /// Without names: all.
  void release(const std::vector<std::string>& motors) {
    for (const auto& motor : motors) newer_from_.erase(motor);
    if (motors.empty()) newer_from_.clear();
  }

  /// The newest state, the last of `states`, or a copy in which the motors are ACTIVE about which it says
  /// nothing.
  [[nodiscard]] std::shared_ptr<const RobotState> corrected(std::shared_ptr<const RobotState> newest,
                                                            std::uint64_t states) const;

  /// States after an answer that may have been taken before it.
  static constexpr std::uint64_t kMayBeOlder = 1;

 private:
  std::map<std::string, std::uint64_t> newer_from_;  ///< Count with the first state that is newer.
};

}  // namespace robot_client
}  // namespace rc10
