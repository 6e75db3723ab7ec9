#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/result.hpp"

namespace rc10::robot_file {

/// Rights and bounds of a program that reads a stranger's text.
struct LesserUser {
  uid_t user = 0;
  gid_t group = 0;
  std::uint64_t cpu_s = 5;
  std::uint64_t memory_bytes = std::uint64_t{512} << 20U;
};

struct ProgramEnd {
  static constexpr int kNotStarted = 127;
  int status = kNotStarted;  ///< As a shell has it: 128 and the signal that ended it.
  std::string output;        ///< stdout and stderr, 32 KiB at most.
};

/// Runs a program, by its path, with an empty environment and `input` as its /proc/self/fd/0, and waits for
/// its end. Only for a process with one thread.
[[nodiscard]] Result<ProgramEnd> runProgram(const std::vector<std::string>& words,
                                            const std::string& input = {},
                                            const std::optional<LesserUser>& as = std::nullopt);

}  // namespace rc10::robot_file
