#pragma once

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"
#include "daemon/guard_beats.hpp"
#include "link/guard_hello.hpp"
#include "link/guard_page.hpp"

namespace rc10 {

/// rc10-guard, which watches this process from outside: uses the one of the run folder, or starts one. Main
/// thread only; the page is the scheduler's.
class GuardProcess {
 public:
  struct Settings {
    std::string run_dir;
    std::string program;  ///< Started where no guard runs.
    link::GuardHello hello;
  };

  /// Returns when the guard has said that it watches. The error says why it does not.
  [[nodiscard]] static Result<std::unique_ptr<GuardProcess>> create(Settings settings);
  GuardProcess(const GuardProcess&) = delete;
  GuardProcess& operator=(const GuardProcess&) = delete;
  ~GuardProcess() = default;

  [[nodiscard]] link::GuardPage& page() noexcept { return *page_; }

  /// Readable when the guard has ended, or answers; -1: there is none.
  [[nodiscard]] int descriptor() const noexcept { return try_ ? try_->greeted.get() : connection_.get(); }

  struct News {
    bool lost = false;  ///< The guard has just ended, or stands still: the robot is to be stopped.
    std::string text;   ///< To be logged; empty: nothing.
  };
  /// Notices the end of the guard, and gets another one, a step with each call; notices that it stands still.
  /// Never waits.
  [[nodiscard]] News supervise(MonotonicTime now);

  /// `at_rest`: the drives are, as far as that can be known, and the guard has nothing to do any more. If not
  /// it acts when this process has died.
  void end(bool at_rest) noexcept;

 private:
  GuardProcess(Settings settings, link::SharedGuardPage page, UniqueFd self)
      : settings_(std::move(settings)), page_(std::move(page)), self_(std::move(self)) {}
  /// To get a guard: one is connected to, started if there is none, greeted, and answers.
  struct Try {
    MonotonicTime deadline;  ///< End of the wait for this step.
    bool started = false;
    UniqueFd greeted{};  ///< Its answer is awaited.
  };

  /// A step of the try in try_, without waiting. True: the guard watches.
  [[nodiscard]] Result<bool> tryOn(Try& tried, MonotonicTime now);
  [[nodiscard]] Result<void> sayHello(int connection);
  [[nodiscard]] News watchBeats(MonotonicTime now);
  void reap() noexcept;

  Settings settings_;
  link::SharedGuardPage page_;
  UniqueFd self_;        ///< pidfd of this process.
  UniqueFd connection_;  ///< Without: nobody watches.
  pid_t child_ = 0;      ///< A guard that we have started.
  std::optional<Try> try_;
  MonotonicTime next_try_{};
  Duration pause_{};          ///< After the next try that fails.
  std::string last_failure_;  ///< Last words of the tries since the guard ended.
  GuardBeats beats_;
};

}  // namespace rc10
