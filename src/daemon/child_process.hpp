#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "app/result.hpp"

namespace rc10 {

struct ChildOptions {
  /// A session of its own, without terminal and standard input: signals to our process group do not reach
  /// it.
  bool own_session = false;
};

/// Starts a program with the signals of a fresh process; its descriptors are 0 to 2. The caller reaps it.
/// Main thread only.
[[nodiscard]] Result<pid_t> startChild(const std::string& program, const std::vector<std::string>& arguments,
                                       const ChildOptions& options = {});

/// The program of that name beside our own executable, so that a build tree uses its own.
[[nodiscard]] std::string siblingProgram(const std::string& name);

}  // namespace rc10
