#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"

namespace rc10::web {

struct ChildLimits {
  std::uint64_t cpu_s = 2;
  Duration patience = std::chrono::seconds{10};  ///< The processor may be busy.
  std::uint64_t memory_bytes = std::uint64_t{256} << 20U;
  std::size_t answer_bytes = std::size_t{2} << 20U;
};

/// Work on the text of a stranger, in a process of its own: it has no file and can open none, and neither its
/// crash nor its time nor its memory is the server's. Only for a process with one thread.
class BoundedChild {
 public:
  using Work = std::string (*)(std::string_view input);

  [[nodiscard]] static Result<BoundedChild> start(Work work, std::string_view input, MonotonicTime now,
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
