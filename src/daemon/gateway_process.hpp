#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"

namespace rc10 {

/// Keeps the LCM gateway running as a process of its own: starts it, notices its end, starts it again
/// with back-off. A dead gateway costs no more than a command timeout. Main thread only.
class GatewayProcess {
 public:
  GatewayProcess(std::string program, std::vector<std::string> arguments);
  GatewayProcess(const GatewayProcess&) = delete;
  GatewayProcess& operator=(const GatewayProcess&) = delete;
  ~GatewayProcess() { stop(); }

  /// Starts it if it is due. Returns what to log, empty for nothing.
  [[nodiscard]] std::string supervise(MonotonicTime now);
  /// Ends it: SIGTERM, and SIGKILL if it has not gone soon.
  void stop() noexcept;

  [[nodiscard]] pid_t pid() const noexcept { return pid_; }

 private:
  [[nodiscard]] Result<void> spawn();

  std::string program_;
  std::vector<std::string> arguments_;
  pid_t pid_ = 0;
  MonotonicTime started_{};
  MonotonicTime next_start_{};
  Duration backoff_;
};

}  // namespace rc10
