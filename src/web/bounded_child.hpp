#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"

namespace rc10::web {

struct ChildLimits {
  std::uint64_t cpu_s = 2;
  std::chrono::seconds patience{10};                       ///< The processor may be busy.
  std::uint64_t memory_bytes = std::uint64_t{160} << 20U;  ///< Less where the server's own bound is lower.
  std::size_t answer_bytes = std::size_t{2} << 20U;
};

/// Work beside the server, in a process of its own: it has no file and can open none, and neither its crash
/// nor its time nor its memory is the server's. It needs no signal to end: one that is given up ends with the
/// server, at its next write or at its own bounds. Only for a process with one thread.
class BoundedChild {
 public:
  /// A function that sees a copy of the server's memory as it is at the start.
  using Work = std::function<std::string()>;

  [[nodiscard]] static Result<BoundedChild> start(const Work& work, MonotonicTime now,
                                                  const ChildLimits& limits = {});
  BoundedChild(BoundedChild&& other) noexcept;
  BoundedChild& operator=(BoundedChild&&) = delete;
  BoundedChild(const BoundedChild&) = delete;
  BoundedChild& operator=(const BoundedChild&) = delete;
  ~BoundedChild();

  /// The answer, once; none: it is not there yet. Never waits.
  [[nodiscard]] std::optional<Result<std::string>> poll(MonotonicTime now);

 private:
  BoundedChild(pid_t pid, UniqueFd answers, MonotonicTime deadline, std::size_t most);
  [[nodiscard]] bool takeBytes();
  void end() noexcept;

  pid_t pid_ = -1;
  UniqueFd answers_;
  MonotonicTime deadline_;
  std::size_t most_bytes_;
  std::string answer_;
};

}  // namespace rc10::web
