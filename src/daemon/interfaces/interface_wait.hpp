#pragma once

#include <functional>
#include <string>

#include "app/time.hpp"
#include "config/robot_config.hpp"

namespace rc10 {

/// The wait of a service for CAN interfaces that come late, as those of a USB adapter do. A start that failed
/// at once would use up the unit's five starts in 30 s, and nothing would start rc10d again: with this wait
/// it goes on trying for ever.
class InterfaceWait {
 public:
  static constexpr Duration kLongest = std::chrono::seconds{8};  // systemd: TimeoutStartSec=15

  /// Is there an interface of this name?
  using Exists = std::function<bool(const std::string&)>;

  explicit InterfaceWait(const RobotConfig& config, Exists exists = kernelHas);

  /// The first interface of the robot that this computer does not have; empty: all are there.
  [[nodiscard]] std::string missing() const;

  enum class End {
    kThere,
    kTooLong,  ///< One is still missing.
    kSignal,   ///< `wakes` became readable.
  };
  /// Until all are there, at most `longest`. Main thread, before start.
  [[nodiscard]] End run(int wakes, Duration longest) const;

 private:
  [[nodiscard]] static bool kernelHas(const std::string& interface);

  std::vector<std::string> interfaces_;
  Exists exists_;
};

}  // namespace rc10
