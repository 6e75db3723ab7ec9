#include "fleet.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "config/load_config.hpp"
#include "config/robot_config.hpp"
#include "drives/dji/dji_family.hpp"
#include "drives/dji/dji_model.hpp"

// In place of the C library's, for this whole program: takes every frame and goes nowhere. What is
// measured is rc10d's own work; a real call costs what the kernel and the driver take.
extern "C" int sendmmsg(int /*fd*/, mmsghdr* /*messages*/, unsigned count, int /*flags*/) {
  return static_cast<int>(count);
}

namespace rc10::bench {
namespace {

constexpr Duration kPeriod{std::chrono::milliseconds{1}};

[[noreturn]] void die(const std::string& why) {
  std::fprintf(stderr, "tick_bench: %s\n", why.c_str());
  std::exit(1);
}

template <typename T>
T must(Result<T> result) {
  if (!result) die(result.error().message);
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

MotorSettings wheel(std::size_t index, int id) {
  MotorSettings config;
  config.name = "motor" + std::to_string(index);
  config.model = kM3508.name;
  config.id = id;
  config.zero_at_power_on = true;
  config.loops = kM3508.current.default_loops;
  return config;
}

RobotConfig configured(const Shape& shape) {
  std::string text = "robot: bench\nbuses:\n";
  for (std::size_t bus = 0; bus < shape.buses; ++bus) {
    text += "  - name: bus" + std::to_string(bus) + "\n    type: sim\n    motors:\n";
    for (std::size_t i = 0; i < shape.motors_per_bus; ++i) {
      text += "      - {name: motor" + std::to_string(bus * shape.motors_per_bus + i) +
              ", model: M3508, id: " + std::to_string(i + 1) + ", zero: power_on}\n";
    }
  }
  auto outcome = parseRobotConfig(text, "bench.yaml");
  if (!outcome) die(outcome.errorText());
  return std::move(*outcome.config);
}

RobotConfig robotConfig(const Shape& shape) {
  if (shape.family == Family::kConfigured) return configured(shape);
  RobotConfig config;
  config.robot = "bench";
  if (shape.family != Family::kDji) return config;
  for (std::size_t bus = 0; bus < shape.buses; ++bus) {
    BusConfig entry;
    entry.name = "bus" + std::to_string(bus);
    entry.type = BusType::kSimulated;
    for (std::size_t i = 0; i < shape.motors_per_bus; ++i) {
      MotorConfig motor;
      motor.family = &djiFamily();
      motor.settings = wheel(bus * shape.motors_per_bus + i, static_cast<int>(i) + 1);
      entry.motors.push_back(std::move(motor));
    }
    config.buses.push_back(std::move(entry));
  }
  return config;
}

void putBigEndian(CanFrame& frame, std::size_t at, std::int32_t value) noexcept {
  const auto bits = static_cast<std::uint16_t>(value);
  frame.data[at] = static_cast<std::uint8_t>(bits >> 8U);
  frame.data[at + 1] = static_cast<std::uint8_t>(bits & 0xFFU);
}

}  // namespace

Fleet::Fleet(const Shape& shape)
    : robot_(makeRobot(shape)),
      scheduler_(*robot_, inboxes_, exchange_, kPeriod),
      supervisor_(*robot_, exchange_) {
  makeFrames(shape);
}

std::unique_ptr<Robot> Fleet::makeRobot(const Shape& shape) {
  auto robot = must(Robot::build(robotConfig(shape)));
  if (shape.family == Family::kWide) addWideMotors(*robot, shape);
  return robot;
}

void Fleet::addWideMotors(Robot& robot, const Shape& shape) {
  constexpr std::size_t kGroup = 4;
  for (std::size_t b = 0; b < shape.buses; ++b) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) die("no socket pair");
    far_ends_.emplace_back(ends[1]);
    robot.buses().push_back({.bus = fdCANbus::adopt("bus" + std::to_string(b), UniqueFd{ends[0]}, true)});
    auto& bus = *robot.buses().back().bus;
    std::vector<WideMotor*> motors;
    for (std::size_t i = 0; i < shape.motors_per_bus; ++i) {
      const CanId feedback_id{0x201U + static_cast<std::uint32_t>(i), false};
      auto motor = std::make_unique<WideMotor>(wheel(b * shape.motors_per_bus + i, 1), feedback_id);
      must(bus.registerMotor(*motor));
      motors.push_back(motor.get());
      // As Robot::build() makes them.
      robot.motors().push_back({.motor = std::move(motor),
                                .bus = b,
                                .feedback_timeout = std::chrono::milliseconds{20},
                                .oldest_heard = std::chrono::milliseconds{10},
                                .most_unheard = std::chrono::milliseconds{18}});
    }
    for (std::size_t first = 0; first < motors.size(); first += kGroup) {
      const CanId command_id{0x100U + static_cast<std::uint32_t>(first), false};
      const auto count = std::min(kGroup, motors.size() - first);
      groups_.push_back(std::make_unique<WideGroup>(command_id, std::span(motors).subspan(first, count)));
      must(bus.registerMotor(*groups_.back()));
    }
    bus.watch(bus.packers().front()->commandIds());
  }
}

void Fleet::makeFrames(const Shape& shape) {
  frames_.resize(shape.buses);
  for (auto& frames : frames_) {
    for (std::size_t i = 0; i < shape.motors_per_bus; ++i) {
      CanFrame frame;
      frame.id = {0x201U + static_cast<std::uint32_t>(i), false};
      frame.length = 8;
      putBigEndian(frame, 4, 500);
      frame.data[6] = 35;
      frames.push_back(frame);
    }
  }
  command_.client = "bench";
  command_.deadline = now_ + std::chrono::hours{24 * 365};
  command_.count = shape.motors();
  for (std::size_t i = 0; i < command_.count; ++i) {
    command_.setpoints[i] = {static_cast<std::uint16_t>(i),
                             Target{.mode = ControlMode::kTotalAngle, .value = 5.0}};
  }
}

void Fleet::advance() noexcept {
  // The rotors go half a turn forth and back, at the speed that they report.
  constexpr std::uint64_t kTicksOneWay = 64;
  constexpr std::int32_t kCountsPerTick = 64;
  constexpr std::int32_t kRotorRpm = 469;  // 64 of 8192 counts a millisecond
  now_ += kPeriod;
  const auto phase = static_cast<std::int32_t>(++ticks_ % (2 * kTicksOneWay));
  const bool forth = phase < static_cast<std::int32_t>(kTicksOneWay);
  const std::int32_t counts =
      kCountsPerTick * (forth ? phase : 2 * static_cast<std::int32_t>(kTicksOneWay) - phase);
  const std::int32_t rpm = forth ? kRotorRpm : -kRotorRpm;
  for (auto& frames : frames_) {
    for (auto& frame : frames) {
      frame.received = now_ - kPeriod / 2;
      putBigEndian(frame, 0, counts);
      putBigEndian(frame, 2, rpm);
    }
  }
}

void Fleet::deliver() noexcept {
  for (std::size_t bus = 0; bus < frames_.size(); ++bus) {
    inboxes_[bus].frames.push(frames_[bus].data(), frames_[bus].size());
  }
}

void Fleet::command() noexcept {
  command_.received = command_.said = now_;
  exchange_.commands.push(command_);
}

// As Scheduler::receive().
void Fleet::receive() noexcept {
  for (std::size_t i = 0; i < robot_->buses().size(); ++i) {
    auto& bus = *robot_->buses()[i].bus;
    inboxes_[i].frames.consume_all([&bus](const CanFrame& frame) { bus.dispatch(frame); });
  }
}

// As Scheduler::tick() from after receive() to send().
void Fleet::control() noexcept {
  const Tick tick{ticks_, now_, seconds(kPeriod)};
  supervisor_.receiveOrders(tick);
  supervisor_.decide(tick);
  for (auto& entry : robot_->motors()) entry.motor->update(tick);
  for (auto& entry : robot_->buses()) entry.bus->packCommands(tick);
  for (auto& entry : robot_->buses()) entry.bus->flush();
}

void Fleet::orderEnable() {
  Order order;
  order.id = 1;
  order.operation = Operation::kEnable;
  for (std::size_t i = 0; i < robot_->motors().size(); ++i) order.motors.set(i);
  exchange_.orders.push(order);
}

bool Fleet::allObey() const noexcept {
  const auto& motors = robot_->motors();
  return !motors.empty() && std::all_of(motors.begin(), motors.end(), [](const Robot::MotorEntry& entry) {
    return entry.motor->ordered() == FrameKind::kCommand && entry.motor->commandValue() != 0.0F;
  });
}

std::uint64_t Fleet::droppedFrames() const noexcept {
  std::uint64_t dropped = 0;
  for (const auto& entry : robot_->buses()) {
    const auto& counters = entry.bus->counters();
    dropped += counters.tx_dropped + counters.rx_unmatched + counters.rx_malformed;
  }
  return dropped;
}

}  // namespace rc10::bench
