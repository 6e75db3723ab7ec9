#pragma once

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace rc10 {

/// For the end of main(): `status`, but 1 if what was printed did not get to where stdout leads, which is
/// told on stderr. A file that was not saved is no success.
[[nodiscard]] inline int statusOfOutput(const char* program, int status) noexcept {
  const bool lost_before = std::ferror(stdout) != 0;
  errno = 0;
  if (std::fflush(stdout) == 0 && !lost_before) return status;
  std::fprintf(stderr, "%s: the output is lost or incomplete: %s\n", program,
               errno != 0 ? std::strerror(errno) : "stdout cannot be written");
  return status != 0 ? status : 1;
}

}  // namespace rc10
