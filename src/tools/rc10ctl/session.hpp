#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "app/time.hpp"
#include "client/link_client.hpp"

namespace rc10::ctl {

/// The exit codes of rc10ctl.
enum class ExitCode : int { kOk = 0, kFailed = 1, kUsage = 2, kNoDaemon = 3 };

/// Options of every verb.
struct Global {
  std::optional<std::string> robot;
  std::optional<std::string> socket;
  bool json = false;
};

inline constexpr const char* kClientName = "rc10ctl";

/// Period and validity of commands to motors and modules.
inline constexpr Duration kSendPeriod = std::chrono::milliseconds{20};
inline constexpr std::int32_t kValidityMs = 100;

/// Whether commands that are sent again and again stay without effect. Counts them: a pause of either
/// program, however long, is no refusal.
class Unheeded {
 public:
  void sent() noexcept { ++since_heeded_; }
  void heeded() noexcept { since_heeded_ = 0; }
  /// More than a state may need to show the first one, or another target in force: 500 ms of commands.
  [[nodiscard]] bool tooOften() const noexcept { return since_heeded_ > kMost; }

 private:
  static constexpr int kMost = 25;
  int since_heeded_ = 0;
};

/// The link socket of the rc10d that the options mean.
[[nodiscard]] Result<std::string> socketOf(const Global& global);

/// Connects to the rc10d that the options mean.
[[nodiscard]] Result<LinkClient> connect(const Global& global, std::uint32_t subscriptions = 0);

/// Prints "rc10ctl: ..." on stderr and returns `code`.
ExitCode complain(const Error& error, ExitCode code);

/// From now on complain() prints {"error": ...} on stdout too: for the program that reads --json there.
void complainInJson();

/// Error when rc10d has closed the connection.
[[nodiscard]] Error rc10dEnded();

/// Whether Ctrl-C or SIGTERM came since catchInterrupt().
[[nodiscard]] bool interrupted() noexcept;
void catchInterrupt();

/// Whether nobody can write to stdin any more: the kernel closes a pipe however its program ends. Does not
/// wait; what was written is thrown away.
[[nodiscard]] bool stdinEnded() noexcept;

/// Waits until something can be received, at most `timeout` and at most until Ctrl-C.
void waitReadable(const LinkClient& rc10d, Duration timeout);

}  // namespace rc10::ctl
