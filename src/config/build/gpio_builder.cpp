#include "config/build/gpio_builder.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace rc10 {
namespace {

// Each half of the wave must see ticks advance: two, so that one that is late does not drop the relay.
constexpr int kMinTicksPerPeriod = 4;

GpioPin readPin(const Settings& settings) {
  GpioPin pin;
  settings.read("chip", pin.chip);
  settings.read("line", pin.line);
  return pin;
}

ContactGpioConfig readContact(const Settings& settings) {
  return {.pin = readPin(settings),
          .closed_is_low = settings.text("closed_level") != "high",
          .internal_bias = settings.text("bias") != "external"};
}

HeartbeatGpioConfig readHeartbeat(const Settings& settings, int rate_hz, Problems& problems) {
  HeartbeatGpioConfig heartbeat{.pin = readPin(settings), .rests_in_estop_after = std::nullopt};
  if (settings.find("stops_on_estop_after_ms")) {
    int after_ms = 0;
    settings.read("stops_on_estop_after_ms", after_ms);
    heartbeat.rests_in_estop_after = std::chrono::milliseconds{after_ms};
  }
  const Duration least = std::chrono::nanoseconds{1'000'000'000 / rate_hz} * kMinTicksPerPeriod;
  const auto given = settings.find("period_ms");
  if (!given) {
    heartbeat.period = std::max(heartbeat.period, least);
    return heartbeat;
  }
  int period_ms = 0;
  settings.read("period_ms", period_ms);
  heartbeat.period = std::chrono::milliseconds{period_ms};
  if (heartbeat.period < least) {
    problems.error(given->place(), given->path,
                   given->text() + " ms are less than four ticks at " + std::to_string(rate_hz) +
                       " Hz: a late tick would drop the relay; use " +
                       std::to_string(std::chrono::ceil<std::chrono::milliseconds>(least).count()) +
                       " ms or more");
  }
  return heartbeat;
}

}  // namespace

void buildGpio(const Settings& top, RobotConfig& robot, Problems& problems) {
  struct Contact {
    const char* key;
    std::optional<ContactGpioConfig>& config;
  };
  const std::array contacts{Contact{"estop_gpio", robot.estop_gpio},
                            Contact{"enabling_gpio", robot.enabling_gpio},
                            Contact{"mode_gpio", robot.mode_gpio}};
  const auto owner = [&contacts](const GpioPin& pin) -> const char* {
    for (const auto& contact : contacts)
      if (contact.config && contact.config->pin == pin) return contact.key;
    return nullptr;
  };
  for (const auto& contact : contacts) {
    const auto given = top.find(contact.key);
    if (!given) continue;
    const auto config = readContact(top.section(contact.key));
    if (const char* other = owner(config.pin)) {
      problems.error(
          given->place(), given->path,
          config.pin.name() + " is the line of " + other + ": each contact needs its own; use another line");
    }
    contact.config = config;
  }
  const auto given = top.find("heartbeat_gpio");
  if (!given) return;
  robot.heartbeat_gpio = readHeartbeat(top.section("heartbeat_gpio"), robot.rate_hz, problems);
  if (const char* other = owner(robot.heartbeat_gpio->pin)) {
    problems.error(given->place(), given->path,
                   robot.heartbeat_gpio->pin.name() + " is the line of " + other +
                       ": an output that switches itself; use another line");
  }
}

}  // namespace rc10
