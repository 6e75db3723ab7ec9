#pragma once

#include <array>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "daemon/devices/robot.hpp"
#include "link/interface_lock.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// The locks of a robot's CAN interfaces, by bus; a simulated bus has none. Held longer than the sockets of
/// the robot. Main thread, then io thread.
class InterfaceLocks {
 public:
  /// Indices of interfaces, and locks. Tests give their own.
  struct Source {
    Result<int> (*find)(const std::string& interface);
    Result<link::InterfaceLock> (*lock)(int index, const std::string& interface, const std::string& robot);
    int (*bound)(int socket);
  };
  [[nodiscard]] static Source system() noexcept;

  InterfaceLocks() = default;
  /// Takes the lock of every bus, before anything is opened. The error names who has it, or the two buses
  /// that are one interface.
  [[nodiscard]] static Result<InterfaceLocks> take(const RobotConfig& config, Source source = system());

  /// Whether the sockets of the robot are those of the locked interfaces: a name may move to another
  /// interface between the two.
  [[nodiscard]] Result<void> check(const Robot& robot) const;

  /// Takes the lock of the interface that has the bus's name now, which need not be the one of before: to be
  /// called before its sockets are opened anew. Its index; the lock of the old one stays until keep().
  [[nodiscard]] Result<int> takeAnew(std::size_t bus, const std::string& interface);
  /// The sockets of the bus are on this interface now: another one that was locked for it is free.
  void keep(std::size_t bus, int index);

 private:
  struct BusLock {
    std::optional<link::InterfaceLock> held;
    std::optional<link::InterfaceLock> next;  ///< Taken for an interface that is not open yet.
  };

  std::string robot_;
  Source source_ = system();
  std::array<BusLock, link::kMaxBuses> locks_;
};

}  // namespace rc10
