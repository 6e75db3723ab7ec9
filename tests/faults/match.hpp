#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/virtual_robot.hpp"
#include "faults/choices.hpp"

namespace rc10::test {

/// Matches and the time between them, with what happens to a sound robot of sane programs there: shoves,
/// slopes, hands, hot motors, plugs pulled and put back, pauses of the computer, gaps in the radio link.
/// Counts the stops that nobody asked for.
class Match {
 public:
  explicit Match(Choices& choices);

  void tick();
  [[nodiscard]] Duration robotTime() const noexcept { return robot_time_; }

  /// Each stop without a cause, with the events before it. A sound robot has none.
  [[nodiscard]] const std::vector<std::string>& nuisances() const noexcept { return nuisances_; }
  /// Each event's count, and the share of the time in which the motors obeyed.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::uint64_t times(const std::string& what) const;
  /// Ticks of motors that were ACTIVE, and of those that were to be.
  [[nodiscard]] double activeShare() const noexcept;
  /// The motors that followed their targets for less than this share of the time in which they were ACTIVE
  /// and commanded, or were never both.
  [[nodiscard]] std::string idlers(double least_share) const;

  /// For tests of the judge: no command arrives from now on, and the judge is not told.
  void sendNothing() { lets_all_stand_ = true; }
  /// For tests of the judge: this motor is unplugged, and the judge is not told.
  void unplugUnnoticed(std::size_t motor);
  /// For its tests: this motor is unplugged, and meanwhile a hand leads it to the opposite of its zero.
  void leadAstray(std::size_t motor);

 private:
  enum class Phase : std::uint8_t { kPit, kStart, kPlay };
  enum class Trouble : std::uint8_t {
    kShove,  ///< Load of some tenths of a second.
    kHand,   ///< Load of seconds, toward an angle.
    kSlope,  ///< Load of half a minute, on each wheel.
    kHeat,   ///< A warm motor.
    kLoose,  ///< Some of its frames are lost.
    kPlug,   ///< Its drive is not heard.
    kBus,    ///< No drive of its bus is heard.
    kPause,  ///< The computer stood still.
    kGap,    ///< No command arrives.
    kEstop,  ///< The button.
    kCount,
  };
  static constexpr auto kTroubles = static_cast<std::size_t>(Trouble::kCount);
  /// A motor that a program commands: where it is going.
  struct Player {
    std::size_t motor = 0;
    std::size_t bus = 0;
    std::size_t drive = 0;
    bool by_module = false;
    Target target;
    double goal = 0.0;
    double most_per_s = 0.0;  ///< Change of the target.
    double reach = 0.0;       ///< The goals lie within it, both ways.
    MonotonicTime next_goal{};
    MonotonicTime loaded_until{};
    MonotonicTime loose_until{};
    MonotonicTime next_gap{};
    MonotonicTime unplugged_until{};
    MonotonicTime
        turned_back_until{};  ///< A person has turned it back into its travel, and turns it no second time.
    MonotonicTime
        excused_until{};  ///< It may stop, and be OFFLINE: its plug, or that of one it is grouped with.
    bool was_active = false;
    bool faulted = false;
    std::uint64_t asked_ticks = 0;     ///< ACTIVE, with commands that have come.
    std::uint64_t followed_ticks = 0;  ///< And those of them in which a target acted on it.
  };

  void begin(Trouble trouble);
  void end();
  void load(Player& player, double torque_nm, Duration time);
  void unplug(std::size_t player, Duration time);
  void excuse(std::size_t motor, MonotonicTime until);
  void drive();
  void aim(Player& player);
  void operate();
  void order(Operation operation, MotorSet motors = {});
  void reference();
  void bringTogether();
  void turnBack(Player& player);
  void judge();
  void nuisance(const std::string& what);
  [[nodiscard]] Player& somebody();
  [[nodiscard]] std::vector<std::size_t> oneThing(std::size_t motor) const;
  [[nodiscard]] Duration between(int least_ms, int most_ms);
  [[nodiscard]] sim::SimBus& busOf(const Player& player) { return robot_.simBus(player.bus); }
  void note(const char* what) { ++counts_[what]; }

  Choices& choices_;
  RobotConfig config_;
  VirtualRobot robot_;
  std::vector<Player> players_;  ///< By motor.
  std::array<double, 3> chassis_{};
  double lift_rpm_ = 0.0;
  double feed_rpm_ = 0.0;
  MonotonicTime next_drive_{};
  MonotonicTime next_trouble_{};
  MonotonicTime silent_until_{};  ///< The programs' commands do not arrive.
  MonotonicTime pressed_until_{};
  MonotonicTime estop_excused_until_{};
  MonotonicTime phase_ends_{};
  MonotonicTime ask_again_{};
  MonotonicTime all_well_{};  ///< Everything is plugged in, and the operator has asked, since.
  bool lets_all_stand_ = false;
  Phase phase_ = Phase::kPit;
  std::uint64_t orders_ = 0;
  std::uint64_t tick_ = 0;
  std::uint64_t active_ticks_ = 0;
  std::uint64_t wanted_ticks_ = 0;
  Duration robot_time_{};
  std::map<std::string, std::uint64_t> counts_;
  std::vector<std::string> nuisances_;
  std::vector<std::string> lately_;  ///< The last things that happened.
};

}  // namespace rc10::test
