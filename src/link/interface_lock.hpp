#pragma once

#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"

namespace rc10::link {

/// Sole use of one CAN interface among the programs that share a run folder: two rc10d on one bus would
/// both command its motors. Held as long as the object lives, and let go of by the kernel however the
/// process ends. Not inherited by other programs. Main thread only.
class InterfaceLock {
 public:
  /// Takes the lock for `robot`. The error says who holds it, or what is wrong with the folder.
  [[nodiscard]] static Result<InterfaceLock> take(const std::string& run_dir, const std::string& interface,
                                                  const std::string& robot);

  /// Present holder: "robot 'hero' (rc10d, pid 123)". Empty: nobody. Takes nothing.
  [[nodiscard]] static std::string holder(const std::string& run_dir, const std::string& interface);

  /// The lock file. An interface of another network namespace is another one, though its name be the same.
  [[nodiscard]] static std::string path(const std::string& run_dir, const std::string& interface);

 private:
  explicit InterfaceLock(UniqueFd file) : file_(std::move(file)) {}

  UniqueFd file_;
};

}  // namespace rc10::link
