#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rc10::link {

/// One run of a program: a process number alone may be another's by now. Not for real-time threads.
struct ProcessIdentity {
  pid_t pid = 0;
  std::uint64_t start_ticks = 0;  ///< Since the computer's start, as /proc has it; 0: unknown.

  [[nodiscard]] static ProcessIdentity own();
  [[nodiscard]] static ProcessIdentity of(pid_t pid);

  /// A line for a file, without its end: "# pid 123, start 4567".
  [[nodiscard]] std::string line() const;
  /// The first such line of a text; empty: there is none.
  [[nodiscard]] static std::optional<ProcessIdentity> in(std::string_view text);

  /// Whether it has not ended yet. One that cannot be looked at runs while its number is taken.
  [[nodiscard]] bool runs() const;
};

}  // namespace rc10::link
