#include "daemon/interfaces/interface_locks.hpp"

#include <utility>

#include <fmt/format.h>

#include "bus/can_socket.hpp"

namespace rc10 {

InterfaceLocks::Source InterfaceLocks::system() noexcept {
  return {.find = findCanInterface, .lock = link::InterfaceLock::take, .bound = boundInterface};
}

Result<InterfaceLocks> InterfaceLocks::take(const RobotConfig& config, Source source) {
  InterfaceLocks locks;
  locks.robot_ = config.robot;
  locks.source_ = source;
  for (std::size_t i = 0; i < config.buses.size(); ++i) {
    const auto& bus = config.buses[i];
    if (bus.type != BusType::kSocketCan) continue;
    const auto index = source.find(bus.interface);
    if (!index) return tl::unexpected(index.error());
    for (std::size_t other = 0; other < i; ++other) {
      const auto& held = locks.locks_[other].held;
      if (!held || held->index() != *index) continue;
      return fail(
          fmt::format("buses '{}' and '{}' are one: {} and {} are names of the same interface; give "
                      "one of them another interface, or their motors one bus",
                      config.buses[other].name, bus.name, config.buses[other].interface, bus.interface));
    }
    auto lock = source.lock(*index, bus.interface, config.robot);
    if (!lock) return tl::unexpected(lock.error());
    locks.locks_[i].held = std::move(*lock);
  }
  return locks;
}

Result<void> InterfaceLocks::check(const Robot& robot) const {
  for (std::size_t i = 0; i < robot.buses().size(); ++i) {
    const auto& entry = robot.buses()[i];
    const auto& held = locks_[i].held;
    if (!held) continue;
    const int locked = held->index();
    if (source_.bound(entry.bus->descriptor()) == locked &&
        (!entry.echo || source_.bound(entry.echo.get()) == locked))
      continue;
    return fail(fmt::format("CAN interface '{}': its name has just moved to another interface; start again",
                            entry.interface));
  }
  return {};
}

Result<int> InterfaceLocks::takeAnew(std::size_t bus, const std::string& interface) {
  auto index = source_.find(interface);
  if (!index) return index;
  auto& [held, next] = locks_[bus];
  if (next && next->index() != *index) next.reset();
  if (next || (held && held->index() == *index)) return index;
  auto lock = source_.lock(*index, interface, robot_);
  if (!lock) return tl::unexpected(lock.error());
  next = std::move(*lock);
  return index;
}

void InterfaceLocks::keep(std::size_t bus, int index) {
  auto& [held, next] = locks_[bus];
  if (next && next->index() == index) held = std::exchange(next, std::nullopt);
  next.reset();
}

}  // namespace rc10
