#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/time.hpp"

namespace rc10 {

/// Real-time threads of the computer that precede a thread, and the CPU time that they use: which of them had
/// its CPU. From /proc, as far as it shows them: ProtectProc=invisible of a unit hides those of others and of
/// the kernel.
class CpuRivals {
 public:
  /// `priority`: the thread's own, SCHED_FIFO.
  explicit CpuRivals(int priority, std::filesystem::path proc = "/proc");

  /// The thread itself. Before the first look().
  void setThread(int tid) noexcept { tid_ = tid; }

  /// Once in each window. Finds the rivals anew first, some processes in each call, so that none takes long;
  /// then notes what they use. True: it did, in this window and the one before.
  bool look();
  /// The rival that used most in the last two windows and ran last on the thread's CPU; empty if it used less
  /// than `least`.
  [[nodiscard]] std::string busiest(Duration least) const;
  /// The next look() finds them anew.
  void forget();

 private:
  struct Rival {
    std::filesystem::path task;  ///< Its folder.
    std::string name;
    std::optional<Duration> used{};  ///< Since it began.
    Duration lately{};               ///< In the last window.
    Duration before{};               ///< In the window before.
  };

  void findSome();
  void take(const std::filesystem::path& task);

  int tid_ = 0;
  int priority_;
  std::filesystem::path proc_;
  std::filesystem::path own_stat_;
  std::optional<std::filesystem::directory_iterator> left_;  ///< Processes to be searched.
  bool found_ = false;
  int windows_ = 0;
  std::vector<Rival> rivals_;
};

}  // namespace rc10
