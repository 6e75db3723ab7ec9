#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "app/time.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "daemon/recording/flight_recorder.hpp"
#include "daemon/supervision/lease.hpp"
#include "daemon/supervision/supervisor.hpp"
#include "module/module_robot.hpp"

namespace rc10 {

/// Runs the modules of a robot: gives them their inputs, and takes what they want to the supervisor, as it
/// does with clients. Scheduler thread only.
class ModuleRunner : private ModuleRobot {
 public:
  /// `recorder`: writes down the inputs, if there is one; outlives this.
  ModuleRunner(Robot& robot, Supervisor& supervisor, LinkExchange& link, FlightRecorder* recorder = nullptr);

  /// Called between the orders of clients and the supervisor's decisions, in the order of the configuration:
  /// a module sees in this tick what those before it send, and in the next what those behind it do.
  void update(const Tick& tick) noexcept;

  void fillSnapshot(Snapshot& snapshot) const noexcept;

 private:
  struct Control {
    Lease lease;           ///< Whose inputs are in force, and until when.
    Lease::Holder sender;  ///< Giver of the last ones, also when they have lapsed.
    MonotonicTime said{};  ///< When a client or a person said them: to this module, or to one that passes
                           ///< them on.
    MonotonicTime last_refusal_report{};
    bool refused = false;  ///< Its last targets.
  };

  void receive(const Tick& tick) noexcept;
  void take(const SignalMessage& message, MonotonicTime said, const Tick& tick) noexcept;
  void handOver(const Tick& tick) noexcept;
  [[nodiscard]] Lease::Holder sender() const noexcept;
  [[nodiscard]] Order orderOf(RobotRequest request) const noexcept;

  [[nodiscard]] RobotStatus state() const noexcept override { return supervisor_.robotState(); }
  [[nodiscard]] std::size_t motorCount() const noexcept override { return robot_.motors().size(); }
  [[nodiscard]] const MotorFeedback& feedback(std::size_t motor) const noexcept override;
  [[nodiscard]] MotorStatus status(std::size_t motor) const noexcept override;
  [[nodiscard]] bool obeys(std::size_t motor) const noexcept override;
  [[nodiscard]] std::uint32_t disables() const noexcept override { return supervisor_.disables(); }
  [[nodiscard]] double speedCeilingRpm(std::size_t motor) const noexcept override {
    return supervisor_.speedCeilingRpm(motor);
  }
  void setTarget(std::size_t motor, const Target& target) noexcept override;
  void ask(RobotRequest request, std::size_t motor, double angle_deg) noexcept override;
  void forgetReference(std::size_t motor) noexcept override { supervisor_.forgetReference(motor); }
  void ask(RobotRequest request, std::span<const std::size_t> motors) noexcept override;
  void askAll(RobotRequest request) noexcept override;
  [[nodiscard]] double clientsSilentSeconds() const noexcept override {
    return supervisor_.clientsSilentSeconds();
  }
  void hearClient(MonotonicTime said) noexcept override {
    said_ = std::min(said_, said);
    supervisor_.hearClient();
  }
  [[nodiscard]] double read(SignalPlace output) const noexcept override;
  void send(SignalPlace input, double value) noexcept override;
  void report(std::size_t event) noexcept override;

  Robot& robot_;
  Supervisor& supervisor_;
  LinkExchange& link_;
  FlightRecorder* recorder_;
  std::vector<Control> controls_;
  Duration validity_;  ///< Time for which a module's targets and inputs hold.
  std::uint64_t refused_signals_ = 0;

  // While a module's update() runs: which it is, and what it has asked for so far.
  std::size_t current_ = 0;
  Tick tick_{};
  MonotonicTime said_{};  ///< When that was said which it follows; now: it acts by itself.
  Command command_;
  MotorSet commanded_;
  std::array<SignalMessage, kMaxModules> messages_;
  std::array<bool, kMaxModules> sent_{};
};

}  // namespace rc10
