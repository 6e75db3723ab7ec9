#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/clients/scan_desk.hpp"
#include "daemon/virtual_robot.hpp"
#include "faults/choices.hpp"
#include "faults/oracle.hpp"

namespace rc10::test {

/// Everything that can be done to a robot, in random order: commands of quarrelling clients, orders,
/// emergency stops, broken drives and buses, missed ticks, restarts. After every tick the oracle judges.
class Chaos {
 public:
  /// For tests of the oracle: what it believes of one robot, wrongly, and has to contradict.
  struct Lie {
    enum class Kind : std::uint8_t {
      kEffort,         ///< A motor has a quarter of its limit of effort.
      kSpeed,          ///< A motor has a quarter of its limit of speed.
      kStuck,          ///< A motor goes on following the first thing that it was told.
      kSlew,           ///< Targets of a motor change at a quarter of its slew limits.
      kSoftStart,      ///< The soft start of a motor takes four times as long.
      kReduced,        ///< A motor may turn at a quarter of its reduced speed.
      kReducedEffort,  ///< A motor may have a quarter of its reduced effort.
      kFallback,       ///< A motor that coasts without commands does what its file says.
      kFirstStep,      ///< The first angle of a motor may be a tenth as far away.
      kTurn,           ///< The travel of a motor lies a turn farther.
      kZero,           ///< Each zero of a motor was asked for a degree higher.
      kGroup,          ///< A motor belongs to the first group of its robot, too.
      kPace,           ///< Scans of a robot listen a minute longer.
      kHoming,         ///< The joints of a robot home at a quarter of their velocity.
      kTravel,         ///< They home within a tenth of their travel.
      kSilence,        ///< Gimbals and joints of a robot hold for a quarter of the time without a client.
      kSoftLimit,      ///< A motor has the middle quarter of its travel.
      kForeign,        ///< One foreign command is enough for a motor's FAULT.
      kValidity,       ///< Commands of a robot are valid for a quarter of their time.
      kEstop,          ///< The robot has got an e-stop.
      kOnDisable,      ///< A motor that coasts when it is disabled does what its file says,
      kOnEstop,        ///< or in an e-stop.
      kHold,           ///< A motor is held a quarter of a turn farther on.
      kFallbackTime,   ///< Fallbacks of a motor last for a quarter of their time.
    };
    std::size_t robot = 0;
    std::size_t motor = 0;
    Kind kind = Kind::kEffort;
  };
  explicit Chaos(Choices& choices, std::optional<Lie> lie = std::nullopt);

  /// One thing happens, then some ticks pass. Throws Violation.
  void step();

  [[nodiscard]] std::uint64_t ticks() const noexcept { return visits_.ticks + oracle_->visits().ticks; }
  [[nodiscard]] Duration robotTime() const noexcept { return robot_time_; }
  [[nodiscard]] Visits visits() const;
  /// Count of each action.
  [[nodiscard]] std::string actionsText() const;
  /// The last things that were done, one a line.
  [[nodiscard]] std::string history() const;

  enum class Action : std::uint8_t {
    kNothing,
    kCommand,
    kProgram,
    kEnable,
    kEnableAlone,
    kDisable,
    kClear,
    kZero,
    kEstop,
    kRepair,
    kSilence,
    kLoseFrames,
    kStall,
    kHeat,
    kEncoder,
    kLoad,
    kFreezeBus,
    kBlockBus,
    kHoldEchoes,
    kLink,
    kController,
    kContact,
    kModeContact,
    kForeignFrames,
    kFloodBus,
    kFillRings,
    kMissTicks,
    kScan,
    kModules,
    kStop,
    kCrash,
    kCount,
  };

 private:
  /// The request desk has no more orders under way.
  static constexpr std::size_t kMostOpen = 64;
  static constexpr auto kActions = static_cast<std::size_t>(Action::kCount);
  /// A client that commands in a loop.
  struct Client {
    const char* name = "";
    int priority = 0;
    std::uint64_t session = 1;
    MotorSet motors;
    std::array<Target, 16> targets{};
    Duration validity{};
    std::uint32_t every_ticks = 10;
  };
  /// Inputs of a module, sent again and again while there are any.
  struct Inputs {
    bool given = false;
    std::array<double, kMaxSignals> values{};
  };
  struct Done {
    std::uint64_t tick = 0;
    Action action{};
    std::uint64_t motors = 0;
    double value = 0.0;
  };

  void start();
  void standSomewhere();
  [[nodiscard]] RobotConfig believed(const Lie& lie) const;
  void act(Action action);
  void tick(std::uint64_t periods = 1);
  void ticks(std::uint64_t count);
  void simulate(Duration dt);
  void deliver(std::size_t bus, CanFrame frame);
  void readBuses();
  void carry(std::size_t bus, const CanFrame& frame);
  [[nodiscard]] const BusCounters& counters(std::size_t bus) const;
  [[nodiscard]] bool isWatched(std::size_t bus, const CanFrame& frame) const;
  void leaveQueue(std::size_t bus);
  void holdEchoes(std::size_t bus, std::uint64_t ticks, bool on_wire);
  void command(const Client& client);
  void chooseInputs();
  void sendInputs();
  void order(Operation operation, MotorSet motors, double value = 0.0);
  void describe();
  void scan();
  void useModules();
  void makeWhole();
  void ask(std::size_t module, double first, double second);
  void leaveGimbal(std::size_t module);
  void homeJoint(std::size_t module);
  [[nodiscard]] double stateOf(std::size_t module) const;
  void judgeReference(std::size_t module);
  void askForScan(std::size_t bus, MotorSet motors);
  void judgeScan();
  void endScan(const OrderResult& result);
  void stopAndStartAgain();
  void repair(std::size_t motor);
  void repairBuses();
  void foreignFrame(std::size_t bus);
  void secondController();
  void errorFrame(std::size_t bus, std::uint32_t which);
  void showContact();
  [[nodiscard]] Target randomTarget(std::size_t motor);
  [[nodiscard]] MotorSet someMotors();
  [[nodiscard]] Client& someClient();
  [[nodiscard]] sim::SimBus& busOf(std::size_t motor);
  [[nodiscard]] std::size_t driveOf(std::size_t motor) const;
  void note(Action action, MotorSet motors, double value = 0.0);

  Choices& choices_;
  std::optional<Lie> lie_;
  RobotConfig config_;
  std::size_t starts_ = 0;
  std::vector<std::pair<std::size_t, std::size_t>> places_;  ///< Bus and drive of each motor.
  std::unique_ptr<VirtualRobot> robot_;
  std::unique_ptr<Oracle> oracle_;
  std::vector<CanReceiver> wires_;  ///< The drives' ends of the buses.
  std::array<CanFrame, CanReceiver::kBatch> batch_{};
  std::array<std::pair<std::size_t, CanFrame>, 32> seen_{};  ///< The daemon's last frames, and their buses.
  std::size_t seen_count_ = 0;
  std::array<CanFrame, 64> feedback_{};
  std::array<Client, 3> clients_{};
  std::vector<Inputs> inputs_;      ///< By module.
  std::bitset<kMaxBuses> frozen_;   ///< Nothing is heard from it.
  std::bitset<kMaxBuses> blocked_;  ///< Nobody takes its frames.
  std::bitset<kMaxBuses> behind_;   ///< Frames from before are still in its queue.
  /// A transmit queue that takes frames and does not move, or echoes that nobody hears.
  struct Queue {
    std::uint64_t stuck_ticks = 0;  ///< From now on.
    bool on_wire = false;           ///< Its frames leave all the same; only their echoes are lost.
    std::vector<CanFrame> frames;   ///< They leave when it moves again.
  };
  std::array<Queue, kMaxBuses> queues_{};
  std::bitset<kMaxBuses> echoed_;                         ///< Since the last tick.
  std::array<BusCounters, kMaxBuses> counters_before_{};  ///< Before this tick.
  bool contact_open_ = false;                             ///< State of the e-stop input.
  bool mode_open_ = false;                                ///< And of the mode input.
  // Scans, and the part of the link thread in them.
  RobotDescription description_;
  std::optional<ScanDesk> desk_;
  std::uint64_t scan_at_desk_ = 0;  ///< Order; 0: there is none.
  bool desk_works_ = true;          ///< Else the link thread has no time.
  std::uint64_t orders_ = 0;
  std::uint64_t tick_ = 0;
  Duration robot_time_{};
  Visits visits_;
  std::array<std::uint64_t, kActions> done_{};
  std::array<Done, 64> history_{};
  std::uint64_t noted_ = 0;
};

}  // namespace rc10::test
