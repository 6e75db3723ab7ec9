#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "app/time.hpp"
#include "client/link_client.hpp"
#include "session.hpp"

namespace rc10::ctl {

/// The fate of the motor in the end.
enum class Then : std::uint8_t {
  kTimeout,  ///< Its on_timeout, as when the program dies.
  kCoast,
  kDisable,  ///< The caller disables it; until then the target acts.
};

/// Command of `set`, `jog` and `commission` to one motor.
struct Drive {
  link::Setpoint setpoint;
  std::size_t motor = 0;  ///< Its place in Welcome and State.
  std::int32_t priority = 0;
  Duration time{};
  Then then = Then::kTimeout;
  /// Called before each sending with the newest state: may change the setpoint. Its result ends the
  /// drive: a reason is a failure, "" the end; empty goes on.
  std::function<std::optional<std::string>(link::Setpoint& setpoint, const link::State& state)> steer;
  /// Called with each event of the motor.
  std::function<void(const link::Event& event)> hear;
};

/// The outcome.
struct Driven {
  ExitCode status = ExitCode::kFailed;
  bool ours = false;  ///< The motor obeyed it, and nobody else since.
};

/// Sends the setpoint again and again for the time, shows what becomes of it, then ends it as `then` says;
/// so it does after Ctrl-C. Fails if the motor is not ACTIVE, now or later, or somebody else holds it.
[[nodiscard]] Driven drive(LinkClient& rc10d, const Drive& order);

}  // namespace rc10::ctl
