#pragma once

#include <linux/can.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/can_receiver.hpp"
#include "bus/wire_frame.hpp"
#include "config/robot_config.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/tick/scheduler.hpp"
#include "drives/dji/dji_family.hpp"
#include "drives/dji/dji_model.hpp"

namespace rc10::test {

/// A motor as the tests use it: defaults of the model, angle zero at power-on.
inline MotorConfig makeMotor(const std::string& name, const DjiModel& model, int id) {
  MotorConfig motor;
  motor.family = &djiFamily();
  motor.settings.name = name;
  motor.settings.model = model.name;
  motor.settings.id = id;
  motor.settings.zero_at_power_on = !model.absolute_output;
  motor.settings.loops = model.current.default_loops;
  motor.settings.velocity_limit_rpm = motor.settings.loops.velocity_limit_rpm;
  motor.settings.feedback_hz = 1000;
  return motor;
}

/// One simulated bus with two wheels, ids 1 and 2, and a GM6020 with id 5.
inline RobotConfig twoWheelsAndYaw() {
  RobotConfig config;
  config.robot = "test";
  config.realtime = RealtimePolicy::kPreferred;
  BusConfig bus;
  bus.name = "chassis";
  bus.type = BusType::kSimulated;
  bus.motors = {makeMotor("left", kM3508, 1), makeMotor("right", kM3508, 2), makeMotor("yaw", kGM6020, 5)};
  config.buses.push_back(std::move(bus));
  return config;
}

/// `left` and `right` of twoWheelsAndYaw(), which stop together.
inline GroupConfig leftAndRight(GroupConfig::Return on_return = GroupConfig::Return::kRequest) {
  GroupConfig group;
  group.name = "drive";
  group.motors = {0, 1};
  group.on_return = on_return;
  return group;
}

/// A whole robot without a thread and without waiting: simulated motors, rings and scheduler, stepped by
/// hand through virtual time.
class VirtualRobot {
 public:
  /// `clock`: when the frames of a tick have left; none: at once.
  explicit VirtualRobot(const RobotConfig& config, FlightRecorder* recorder = nullptr,
                        Scheduler::Clock clock = nullptr)
      : period_(config.period()) {
    robot_ = std::move(Robot::build(config).value());
    for (auto& entry : robot_->buses()) receivers_.emplace_back(entry.bus->descriptor());
    scheduler_ = std::make_unique<Scheduler>(*robot_, inboxes_, exchange_, period_, recorder, clock);
  }

  /// Half a period of simulation, reception, one tick.
  void tick(std::uint64_t periods = 1) {
    now_ += period_ * static_cast<std::int64_t>(periods);
    for (std::size_t i = 0; i < robot_->simPorts().size(); ++i) {
      if (!frozen_.test(i)) robot_->simPorts()[i]->step(now_ - period_ / 2);
    }
    receive();
    scheduler_->tick(now_, periods);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }

  /// Every frame that the drives send from now on is added there.
  void record(std::vector<CanFrame>& frames) { heard_ = &frames; }

  /// Frames are stamped so much later than they were sent, up to half a period.
  void stampLate(Duration by) { stamp_delay_ = by; }

  /// Frames of the daemon on the first bus since the last tick, before its drives see them.
  std::vector<CanFrame> takeFrames() {
    std::vector<CanFrame> frames;
    canfd_frame wire;
    for (;;) {
      const auto size = ::recv(robot_->simPorts()[0]->descriptor(), &wire, sizeof wire, MSG_DONTWAIT);
      if (size <= 0) return frames;
      CanFrame frame;
      EXPECT_TRUE(decodeFrame(wire, static_cast<std::size_t>(size), frame));
      frames.push_back(frame);
    }
  }

  void freezeSimulation(bool frozen) { frozen ? frozen_.set() : frozen_.reset(); }
  void freezeBus(std::size_t bus, bool frozen) { frozen_.set(bus, frozen); }

  /// Hands an order for all motors to the supervisor and runs until it is answered.
  OrderResult order(Operation operation, double value = 0.0) {
    MotorSet all;
    for (std::size_t i = 0; i < robot_->motors().size(); ++i) all.set(i);
    Order order;
    order.operation = operation;
    order.motors = all;
    order.value = value;
    order.whole_robot = true;
    return carryOut(order);
  }
  /// The same for motors that are named.
  OrderResult orderFor(MotorSet motors, Operation operation, double value = 0.0) {
    Order order;
    order.operation = operation;
    order.motors = motors;
    order.value = value;
    return carryOut(order);
  }
  /// As a client that does not wait for the answer.
  void beginEnabling(MotorSet motors) {
    Order order;
    order.id = 99;
    order.operation = Operation::kEnable;
    order.motors = motors;
    ASSERT_TRUE(exchange_.orders.push(order));
  }
  OrderResult carryOut(Order order) {
    order.id = ++orders_;
    exchange_.orders.push(order);
    OrderResult result;
    for (int i = 0; i < 2500; ++i) {  // 2 s for a drive to be enabled
      tick();
      if (exchange_.results.pop(result)) return result;
    }
    ADD_FAILURE() << "the order was not answered";
    return result;
  }

  void command(std::size_t motor, Target target, Duration validity = std::chrono::milliseconds{50}) {
    Command command;
    command.client = "test";
    command.received = command.said = now_;
    command.deadline = now_ + validity;
    command.count = 1;
    command.setpoints[0] = {static_cast<std::uint16_t>(motor), target};
    ASSERT_TRUE(exchange_.commands.push(command));
  }

  /// Inputs of the first module, the others not given.
  void giveInputs(std::initializer_list<double> values, Duration validity) {
    SignalMessage message;
    message.client = "program";
    message.session = 7;
    message.received = now_;
    message.deadline = now_ + validity;
    message.values.fill(kNoSignal);
    std::copy(values.begin(), values.end(), message.values.begin());
    ASSERT_TRUE(exchange_.signals.push(message));
  }

  /// As another client than command() is.
  void commandAs(const char* client, int priority, std::size_t motor, Target target,
                 Duration validity = std::chrono::milliseconds{50}) {
    Command command;
    command.client = client;
    command.priority = priority;
    command.received = command.said = now_;
    command.deadline = now_ + validity;
    command.count = 1;
    command.setpoints[0] = {static_cast<std::uint16_t>(motor), target};
    ASSERT_TRUE(exchange_.commands.push(command));
  }

  /// Commands one motor in every tick for a while.
  void hold(std::size_t motor, Target target, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      command(motor, target);
      tick();
    }
  }

  const Snapshot& snapshot() { return exchange_.snapshot.read(); }
  const MotorSnapshot& motor(std::size_t index) { return snapshot().motors[index]; }
  /// Every event since the last call.
  std::vector<Event> events() {
    std::vector<Event> out;
    Event event;
    while (exchange_.events.pop(event)) out.push_back(event);
    return out;
  }

  Robot& robot() { return *robot_; }
  Scheduler& scheduler() { return *scheduler_; }
  LinkExchange& exchange() { return exchange_; }
  std::array<BusInbox, kMaxBuses>& inboxes() { return inboxes_; }
  sim::SimBus& simBus(std::size_t index = 0) { return robot_->simPorts()[index]->bus(); }
  MonotonicTime now() const { return now_; }

 private:
  void receive() {
    // Stamps of the host's clock mean nothing in virtual time: they are clamped to now.
    const WakeUp wake{.now = now_, .previous = now_, .realtime_offset = {}, .previous_offset = {}};
    for (auto& inbox : inboxes_)
      if (inbox.echo_reads != 0) ++inbox.echo_reads;
    for (std::size_t i = 0; i < receivers_.size(); ++i) {
      const auto reception = receivers_[i].receive(wake, batch_);
      for (std::size_t k = 0; k < reception.frame_count; ++k) batch_[k].received += stamp_delay_;
      inboxes_[i].frames.push(batch_.data(), reception.frame_count);
      if (heard_ != nullptr) {
        heard_->insert(heard_->end(), batch_.begin(),
                       batch_.begin() + static_cast<std::ptrdiff_t>(reception.frame_count));
      }
    }
  }

  Duration period_;
  MonotonicTime now_{std::chrono::seconds{1000}};
  std::unique_ptr<Robot> robot_;
  std::array<BusInbox, kMaxBuses> inboxes_;
  LinkExchange exchange_;
  std::unique_ptr<Scheduler> scheduler_;
  std::vector<CanReceiver> receivers_;
  std::array<CanFrame, CanReceiver::kBatch> batch_{};
  std::uint64_t orders_ = 0;
  std::vector<CanFrame>* heard_ = nullptr;
  std::bitset<kMaxBuses> frozen_;
  Duration stamp_delay_{};
};

}  // namespace rc10::test
