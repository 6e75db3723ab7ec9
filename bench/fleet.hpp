#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "daemon/devices/robot.hpp"
#include "daemon/tick/scheduler.hpp"
#include "wide_motor.hpp"

namespace rc10::bench {

enum class Family : std::uint8_t {
  kDji,         ///< M3508 and DJI_Group without guards: at most 8 a bus.
  kConfigured,  ///< The same with the guards and limits that a configuration's defaults are.
  kWide,        ///< WideMotor: the work of kDji, at most 32 a bus.
};

struct Shape {
  std::string_view name;
  Family family{};
  std::size_t buses = 1;
  std::size_t motors_per_bus = 1;

  [[nodiscard]] constexpr std::size_t motors() const noexcept { return buses * motors_per_bus; }
};

inline constexpr std::array<Shape, 7> kShapes{{{"dji_1", Family::kDji, 1, 1},
                                               {"dji_8", Family::kDji, 1, 8},
                                               {"configured_2x4", Family::kConfigured, 2, 4},
                                               {"dji_4x8", Family::kDji, 4, 8},
                                               {"wide_8", Family::kWide, 1, 8},
                                               {"wide_32", Family::kWide, 1, 32},
                                               {"wide_4x32", Family::kWide, 4, 32}}};

/// A robot with every motor ACTIVE in total-angle mode: both loops run in each tick. Virtual time, no
/// thread, and no system call: frames go straight into the rings, and sendmmsg is replaced (fleet.cpp).
class Fleet {
 public:
  explicit Fleet(const Shape& shape);

  /// A millisecond passes: the next frame of every motor.
  void advance() noexcept;
  /// Puts these frames into the rings as the RX thread does it: one push a bus.
  void deliver() noexcept;
  /// Hands over one command for every motor, as the link thread does it.
  void command() noexcept;

  /// The whole tick.
  void tick() noexcept { scheduler_.tick(now_); }

  // The tick in parts, in its order. They have a supervisor of their own, so a fleet is driven either
  // by tick() or by these.
  void receive() noexcept;
  void control() noexcept;

  /// Enables every motor and commands it, with the given tick (which advances and delivers). False: not all
  /// of them obey.
  template <typename TickFunction>
  [[nodiscard]] bool start(TickFunction one_tick);

  [[nodiscard]] std::uint64_t droppedFrames() const noexcept;
  [[nodiscard]] std::size_t motors() const noexcept { return robot_->motors().size(); }
  /// Frames of one deliver().
  [[nodiscard]] std::size_t framesPerBus() const noexcept { return frames_.front().size(); }

 private:
  [[nodiscard]] std::unique_ptr<Robot> makeRobot(const Shape& shape);
  void addWideMotors(Robot& robot, const Shape& shape);
  void makeFrames(const Shape& shape);
  void orderEnable();
  [[nodiscard]] bool allObey() const noexcept;

  std::vector<std::unique_ptr<WideGroup>> groups_;
  std::vector<UniqueFd> far_ends_;
  std::unique_ptr<Robot> robot_;  // complete before the scheduler and the supervisor see it
  std::array<BusInbox, kMaxBuses> inboxes_;
  LinkExchange exchange_;
  Scheduler scheduler_;
  Supervisor supervisor_;
  std::vector<std::vector<CanFrame>> frames_;  // one per bus
  Command command_;
  MonotonicTime now_{std::chrono::seconds{1000}};
  std::uint64_t ticks_ = 0;
};

template <typename TickFunction>
bool Fleet::start(TickFunction one_tick) {
  constexpr int kTicks = 50;
  const auto run = [&] {
    for (int i = 0; i < kTicks; ++i) {
      one_tick(*this);
    }
  };
  run();  // feedback first: OFFLINE becomes READY
  orderEnable();
  run();
  command();
  run();
  return allObey();
}

}  // namespace rc10::bench
