#pragma once

#include <unistd.h>

#include <string>

#include "app/unique_fd.hpp"

namespace rc10 {

/// The terminal at this descriptor once more, for writes that wait for nobody: its mode belongs to all who
/// share it. None: it is no terminal, or /proc is closed to a process that is not dumpable.
[[nodiscard]] UniqueFd unblockedTerminal(int fd) noexcept;

/// Lines on stderr of a process that waits for no reader: a terminal that is held (Ctrl-S) or hangs, a full
/// pipe and a full socket lose lines.
class StderrLines {
 public:
  /// Before /proc is closed.
  explicit StderrLines(int fd = STDERR_FILENO) noexcept;

  /// False: lost, or cut off.
  bool tell(std::string line) const noexcept;

 private:
  int fd_;
  UniqueFd terminal_;
};

}  // namespace rc10
