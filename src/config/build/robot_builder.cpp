#include "config/build/robot_builder.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "config/build/bus_builder.hpp"
#include "config/build/client_builder.hpp"
#include "config/build/gpio_builder.hpp"
#include "config/build/group_builder.hpp"
#include "config/build/implied_groups.hpp"
#include "config/build/lcm_url.hpp"
#include "config/build/module_builder.hpp"
#include "config/build/reduced_builder.hpp"
#include "config/keys/profiles.hpp"
#include "config/keys/settings.hpp"

namespace rc10 {
namespace {

constexpr int kNanosecondsPerSecond = 1'000'000'000;

/// Names that many robots have because the shipped examples have them.
constexpr std::array<std::string_view, 11> kSharedNames{
    "robot",      "demo",          "rc10d",          "four_wheels_can0",
    "vcan_mixed", "many_families", "full_reference", "who_may_what",
    "gripper",    "acme",          "small"};

bool isSharedName(std::string_view name) {
  return std::find(kSharedNames.begin(), kSharedNames.end(), name) != kSharedNames.end();
}

void readThread(const Settings& settings, ThreadConfig& thread) {
  settings.read("priority", thread.priority);
  if (const auto cpu = settings.number("cpu")) thread.cpu = static_cast<int>(*cpu);
}

/// The rates on either side of `rate_hz` that have a whole number of nanoseconds as period.
std::string neighbouringRates(int rate_hz) {
  int below = rate_hz;
  int above = rate_hz;
  while (kNanosecondsPerSecond % below != 0) --below;
  while (kNanosecondsPerSecond % above != 0) ++above;
  return std::to_string(below) + " or " + std::to_string(above);
}

class RobotBuilder {
 public:
  RobotBuilder(const YamlNode& root, Problems& problems)
      : root_(root), top_({{&root, ""}}), problems_(problems) {}

  RobotConfig build() {
    top_.read("robot", robot_.robot);
    robot_.realtime =
        top_.text("realtime") == "preferred" ? RealtimePolicy::kPreferred : RealtimePolicy::kRequired;
    const auto guard = top_.text("guard");
    robot_.guard = guard == "required" ? GuardPolicy::kRequired
                   : guard == "off"    ? GuardPolicy::kOff
                                       : GuardPolicy::kPreferred;
    readUnrest();
    robot_.receive = top_.text("receive") == "thread" ? ReceivePolicy::kThread : ReceivePolicy::kTick;
    readThreads();
    readLcm();
    buildGpio(top_, robot_, problems_);
    top_.read("blackbox_mib", robot_.blackbox_mib);
    readBuses();
    checkModeInput(top_, robot_, problems_);
    robot_.groups = buildGroups(top_, robot_.buses, problems_);
    robot_.modules = buildModules(top_, robot_.buses, problems_);
    addImpliedGroups(robot_, problems_);
    buildClients(top_, robot_, problems_);
    return std::move(robot_);
  }

 private:
  void readUnrest() {
    const auto given = top_.find("on_unrest");
    if (!given) return;
    const auto policy = given->text();
    robot_.unrest = policy == "estop"       ? UnrestPolicy::kEstop
                    : policy == "heartbeat" ? UnrestPolicy::kHeartbeat
                                            : UnrestPolicy::kGroup;
    if (robot_.unrest != UnrestPolicy::kHeartbeat || top_.find("heartbeat_gpio")) return;
    problems_.error(given->place(), given->path,
                    "there is no heartbeat that could stop; add heartbeat_gpio, or write estop");
  }

  void readThreads() {
    const Settings scheduler = top_.section("scheduler");
    readThread(scheduler, robot_.scheduler);
    const Settings rx = top_.section("rx");
    readThread(rx, robot_.rx);
    if (const auto lead_us = rx.number("lead_us"))
      robot_.rx_lead = std::chrono::round<Duration>(std::chrono::duration<double, std::micro>(*lead_us));
    const auto timer = scheduler.text("timer");
    robot_.timer = timer == "timerfd"     ? TimerPolicy::kTimerfd
                   : timer == "nanosleep" ? TimerPolicy::kNanosleep
                                          : TimerPolicy::kAuto;
    scheduler.read("phase", robot_.phase_of_period);
    if (scheduler.text("phase_clock") == "realtime") robot_.phase_clock = PhaseClock::kRealtime;
    if (const auto overload_ms = scheduler.number("overload_ms"))
      robot_.overload = std::chrono::milliseconds{static_cast<std::int64_t>(*overload_ms)};
    checkPriorities();
    const auto rate = scheduler.find("rate_hz");
    scheduler.read("rate_hz", robot_.rate_hz);
    if (!rate || kNanosecondsPerSecond % robot_.rate_hz == 0) return;
    problems_.error(rate->place(), rate->path,
                    "a period of 1/" + rate->text() + " s is no whole number of nanoseconds; use " +
                        neighbouringRates(robot_.rate_hz));
    robot_.rate_hz = RobotConfig{}.rate_hz;
  }

  void checkPriorities() {
    if (robot_.rx.priority > robot_.scheduler.priority) return;
    const auto rx = top_.section("rx").find("priority");
    const auto given = rx ? rx : top_.section("scheduler").find("priority");
    if (!given) return;
    problems_.error(
        given->place(), given->path,
        "rx.priority " + std::to_string(robot_.rx.priority) + " is not above scheduler.priority " +
            std::to_string(robot_.scheduler.priority) +
            ": a frame that has arrived would miss the tick that needs it; raise rx.priority or lower "
            "scheduler.priority");
  }

  void readLcm() {
    const Settings lcm = top_.section("lcm");
    lcm.read("enabled", robot_.lcm.enabled);
    lcm.read("url", robot_.lcm.url);
    lcm.read("state_hz", robot_.lcm.state_hz);
    const auto given = lcm.find("url");
    if (!given) return;
    const auto url = parseLcmUrl(given->text());
    if (!url) {
      problems_.error(given->place(), given->path, url.error().message);
    } else if (url->ttl > 0 && robot_.lcm.enabled && isSharedName(robot_.robot)) {
      problems_.error(
          given->place(), given->path,
          "ttl=" + std::to_string(url->ttl) + " reaches the network, and " + inQuotes(robot_.robot) +
              " is the name of an example: a neighbour's robot would obey; give the robot a name of its own, "
              "or use ttl=0");
    } else if (url->ttl > 0 && robot_.lcm.enabled) {
      robot_.lcm.leaves_computer = true;
      problems_.warning(
          given->place(), given->path,
          "ttl=" + std::to_string(url->ttl) + " reaches the network, and LCM has no passwords: " +
              (top_.mentions("clients") ? "every computer there may stop this robot, and forge its state"
                                        : "every computer there may command this robot") +
              ". Use ttl=0, or a network of the robot alone");
    }
  }

  void readBuses() {
    const auto buses = top_.find("buses");
    if (!buses) return;
    Profiles profiles{root_};
    BusBuilder builder{profiles, robot_.rate_hz, problems_};
    for (std::size_t i = 0; i < buses->node->items.size(); ++i) {
      const YamlNode& node = buses->node->items[i];
      if (!node.refused) robot_.buses.push_back(builder.build(node, joinPath(buses->path, i)));
    }
    profiles.checkUse(problems_);
  }

  const YamlNode& root_;
  Settings top_;
  Problems& problems_;
  RobotConfig robot_;
};

}  // namespace

RobotConfig buildRobot(const YamlNode& root, Problems& problems) {
  return RobotBuilder{root, problems}.build();
}

}  // namespace rc10
