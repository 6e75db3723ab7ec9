#pragma once

#include <string>

#include "app/unique_fd.hpp"

namespace rc10 {

/// The meaning of a signal to rc10d.
enum class SignalMeaning {
  kStop,     ///< The orderly stop: fallbacks, rest until echoed, exit 0.
  kChild,    ///< The gateway has ended.
  kIgnored,  ///< Told, and nothing else: a log line must not end a match.
};
[[nodiscard]] SignalMeaning meaningOf(int signal) noexcept;
/// "SIGHUP (the terminal was closed)"; for an ignored one with its remedy.
[[nodiscard]] std::string describeSignal(int signal);

/// Takes every signal that would end or stop the process, but those of its own faults, as something to read:
/// rc10d neither freezes with torque nor dies without rest. SIGKILL and SIGSTOP cannot be taken. A SIGHUP
/// that was ignored when the process began, as by nohup, stays ignored. Made before the first thread, so that
/// every thread inherits the blocked signals and none of them dies of one.
class SignalInbox {
 public:
  SignalInbox() noexcept;

  [[nodiscard]] int descriptor() const noexcept { return fd_.get(); }

  /// The next signal that has come, or 0.
  [[nodiscard]] int take() noexcept;

 private:
  UniqueFd fd_;
};

}  // namespace rc10
