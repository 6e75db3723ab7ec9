#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <stop_token>

#include "app/result.hpp"
#include "app/time.hpp"
#include "config/robot_config.hpp"
#include "daemon/devices/gpio.hpp"
#include "daemon/devices/heartbeat.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/tick/scheduler.hpp"

namespace rc10 {

/// The gpio thread: watches the e-stop input and the mode input, and toggles the heartbeat while the
/// scheduler ticks. The scheduler never waits for a chip, which may sit behind a slow bus.
class GpioLoop {
 public:
  /// Opens what is configured; nullptr where nothing is. A safety input that is missing is an error.
  [[nodiscard]] static Result<std::unique_ptr<GpioLoop>> create(const RobotConfig& config,
                                                                LinkExchange& link);

  /// Each may be missing. `enabling`: the contact of an enabling switch; `mode`: the one that is open while
  /// speed and current are to be reduced.
  GpioLoop(std::unique_ptr<ContactInput> contact, std::optional<Heartbeat> heartbeat, LinkExchange& link,
           std::unique_ptr<ContactInput> enabling = nullptr, std::unique_ptr<ContactInput> mode = nullptr);

  /// The thread's body.
  void run(const std::stop_token& stop, const Scheduler& scheduler) noexcept;
  /// One look at the inputs, waiting for a change until the heartbeat is due or kLookInterval is over, and
  /// then the heartbeat.
  void turn(MonotonicTime now, std::uint64_t ticks) noexcept;

  /// True once, when the heartbeat output has refused. One thread may ask.
  [[nodiscard]] bool takeHeartbeatFailure() noexcept {
    return !heartbeat_told_ && (heartbeat_told_ = heartbeat_failed_.load());
  }

 private:
  [[nodiscard]] ContactState look(Duration patience) noexcept;

  std::unique_ptr<ContactInput> contact_;
  std::unique_ptr<ContactInput> enabling_;
  std::unique_ptr<ContactInput> mode_;
  std::optional<Heartbeat> heartbeat_;
  LinkExchange& link_;
  std::atomic<bool> heartbeat_failed_{false};
  bool heartbeat_told_ = false;
};

}  // namespace rc10
