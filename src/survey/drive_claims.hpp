#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/can_frame.hpp"
#include "bus/frame_listener.hpp"
#include "drives/recogniser.hpp"
#include "motor/motor_family.hpp"

namespace rc10::survey {

/// A motor of the robot's file, on the bus that is looked at.
struct KnownMotor {
  std::string name;
  const MotorFamily* family = nullptr;
  int id = 0;
  std::vector<FrameFilter> sends{};   ///< BusUse::sends
  std::vector<FrameFilter> steers{};  ///< BusUse::steering()
};

/// Motors to which the drives that are heard belong. Not for real-time threads: it allocates.
class DriveClaims {
 public:
  struct Claim {
    std::size_t motor = 0;
    bool collides = false;  ///< A drive of another family sends under the id of the motor's.
    bool assumed = false;   ///< By the file alone: the guess is of another family, but fits the motor's, too.
  };

  explicit DriveClaims(std::vector<KnownMotor> motors)
      : motors_(std::move(motors)), heard_without_guess_(motors_.size()) {}

  void take(const CanFrame& frame);

  /// The motor whose drive this guess is; none: it is not in the file.
  [[nodiscard]] std::optional<Claim> of(const DriveGuess& guess) const;
  /// Motors of which nothing was heard.
  [[nodiscard]] std::vector<std::string> unheard() const;
  /// The motor that would take this question, or an answer to it, for a command, whether its drive is heard
  /// or not: "motor 'arm'". Empty: none.
  [[nodiscard]] std::string commandedBy(const CanFrame& question) const;
  [[nodiscard]] const std::vector<KnownMotor>& motors() const noexcept { return motors_; }

 private:
  /// A drive that is heard under the id of no motor.
  void takeStranger(const DriveGuess& guess);
  [[nodiscard]] bool isStranger(const DriveGuess& guess) const;

  std::vector<KnownMotor> motors_;
  std::vector<std::pair<DriveGuess, Claim>> claims_;
  std::vector<DriveGuess> strangers_;
  /// Motors heard by frames that no recogniser takes, or takes for another motor's.
  std::vector<bool> heard_without_guess_;
};

}  // namespace rc10::survey
