#pragma once

#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"

namespace rc10::link {

/// Sole use of one CAN interface: two rc10d on one bus would both command its motors. The lock is a name in
/// the abstract name space of Unix sockets, which each network namespace has for itself, and it goes by the
/// index of the interface: neither another name of it nor another run folder is a way around it. Held as long
/// as the object lives, and let go of by the kernel however the process ends. Not inherited by other
/// programs. Not for real-time threads. Reasons: docs/decisions/0028.
class InterfaceLock {
 public:
  /// Takes the lock of the interface with this index for `robot`. The error names the interface as
  /// `interface` and says who holds the lock.
  [[nodiscard]] static Result<InterfaceLock> take(int index, const std::string& interface,
                                                  const std::string& robot);

  /// Present holder: "robot 'hero' (rc10d, pid 123)". Empty: nobody. Takes nothing.
  [[nodiscard]] static std::string holder(int index);

  /// The index of the interface.
  [[nodiscard]] int index() const noexcept { return index_; }

 private:
  InterfaceLock(int index, UniqueFd lock, UniqueFd words)
      : index_(index), lock_(std::move(lock)), words_(std::move(words)) {}

  int index_;
  UniqueFd lock_;
  UniqueFd words_;  ///< A second name, in which others read who holds the first.
};

/// Present holder of the interface of this name, as InterfaceLock::holder(); empty, too, where there is none.
[[nodiscard]] std::string holderOfInterface(const std::string& interface);

}  // namespace rc10::link
