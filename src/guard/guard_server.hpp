#pragma once

#include <poll.h>
#include <signal.h>

#include <span>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "app/unique_fd.hpp"
#include "guard/guard_socket.hpp"
#include "guard/watched_robot.hpp"

namespace rc10::guard {

/// Watches every rc10d that said hello. One thread, which wakes up every Standstill::kStepMs while there is
/// one.
class GuardServer {
 public:
  explicit GuardServer(GuardSocket socket);

  /// Waits for the next step, a hello, a death or a signal, and does what it asks for. Returns what to tell,
  /// line by line.
  [[nodiscard]] std::vector<std::string> serve(const sigset_t& signals_while_waiting);
  /// No robot is watched.
  [[nodiscard]] bool unused() const noexcept { return robots_.empty() && visitors_.empty(); }
  /// A robot is being told to rest.
  [[nodiscard]] bool rests() const noexcept;

 private:
  void welcome(std::vector<std::string>& news);
  void hear(std::vector<std::string>& news);
  /// `deaths`: of the robots' processes, in their order, as the wait has found them.
  void step(std::span<const pollfd> deaths, std::vector<std::string>& news);

  GuardSocket socket_;
  MonotonicTime next_step_{};
  std::vector<UniqueFd> visitors_;  ///< Connections without a hello yet.
  std::vector<WatchedRobot> robots_;
};

}  // namespace rc10::guard
