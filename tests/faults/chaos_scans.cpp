// Scans that clients ask for: at any moment, also beside one another, and some of them leave.
#include <chrono>
#include <utility>

#include "faults/chaos.hpp"

namespace rc10::test {

using namespace std::chrono_literals;

// As rc10d describes itself to its link thread: what a scan needs of it.
void Chaos::describe() {
  description_ = {};
  description_.robot = config_.robot;
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    description_.buses.push_back({.name = config_.buses[bus].name, .interface = ""});
    for (const auto& motor : config_.buses[bus].motors) {
      auto use = motor.family->busUse(motor.settings);
      RobotDescription::Motor described;
      described.name = motor.name();
      described.bus = bus;
      described.id = motor.settings.id;
      described.family = motor.family;
      described.sends = std::move(use.sends);
      described.steers = use.steering();
      description_.motors.push_back(std::move(described));
    }
  }
}

void Chaos::scan() {
  if (scan_at_desk_ != 0 && choices_.oneIn(2)) {
    robot_->exchange().scan.given_up.store(scan_at_desk_, std::memory_order_relaxed);
    oracle_->scanLeft(scan_at_desk_);
    return;
  }
  const std::size_t bus = choices_.next(static_cast<std::uint32_t>(wires_.size()));
  MotorSet motors;
  for (std::size_t i = 0; i < places_.size(); ++i) motors.set(i, places_[i].first == bus);
  // Mostly at a moment at which it may begin, and often undisturbed.
  if (!choices_.oneIn(3)) {
    for (int i = 0; i < 2; ++i) order(Operation::kDisable, motors);  // the second lets go
    order(Operation::kClear, motors);
    ticks(choices_.of<std::uint64_t>({1, 60, 400, 1'000}));
  }
  askForScan(bus, motors);
  ticks(choices_.of<std::uint64_t>({1, 60, 400, 2'500}));
}

// One that another client asks for beside it does not come to the desk.
void Chaos::askForScan(std::size_t bus, MotorSet motors) {
  if (oracle_->open() >= kMostOpen) return;
  Order order;
  order.id = ++orders_;
  order.operation = Operation::kScan;
  order.motors = motors;
  order.scan = {.bus = bus,
                .listen = std::chrono::milliseconds{choices_.of<int>({1, 20, 100, 300})},
                .between = std::chrono::milliseconds{choices_.of<int>({2, 2, 2, 5})},
                .listen_only = choices_.oneIn(8)};
  const bool at_desk = desk_->begin(order, {});
  if (!robot_->exchange().orders.push(order)) {
    if (at_desk) desk_->abandon(order.id);
    return;
  }
  if (at_desk) {
    scan_at_desk_ = order.id;
    desk_works_ = !choices_.oneIn(8);
  }
  if (lie_ && lie_->kind == Lie::Kind::kPace) order.scan.listen += 1min;
  oracle_->ordered(order);
}

// A hundred times a second.
void Chaos::judgeScan() {
  constexpr std::uint64_t kEveryTicks = 10;
  if (scan_at_desk_ != 0 && desk_works_ && tick_ % kEveryTicks == 0) desk_->turn();
}

void Chaos::endScan(const OrderResult& result) {
  if (scan_at_desk_ == 0 || result.id != scan_at_desk_) return;
  (void)desk_->end(result);
  scan_at_desk_ = 0;
}

}  // namespace rc10::test
