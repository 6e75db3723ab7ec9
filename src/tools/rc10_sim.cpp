// rc10-sim: stands in for the motors of a robot on real (or virtual) CAN interfaces, as a process of its
// own. To rc10d, candump and any other node they are drives on the bus.

#include <poll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/nearest.hpp"
#include "app/result.hpp"
#include "app/subnormals.hpp"
#include "app/time.hpp"
#include "app/timespec.hpp"
#include "app/unique_fd.hpp"
#include "bus/can_socket.hpp"
#include "config/build/simulated_bus.hpp"
#include "config/load_config.hpp"
#include "program.hpp"
#include "rc10_version.hpp"
#include "sim/sim_port.hpp"

namespace rc10 {
namespace {

constexpr Duration kPeriod{std::chrono::milliseconds{1}};

struct Options {
  std::string config;
  std::vector<std::string> buses;  ///< NAME or NAME=INTERFACE; none: every SocketCAN bus of the file.
  std::optional<std::uint64_t> seed;
  double duration_s = 0.0;  ///< 0: until a signal comes.
};

/// A bus to simulate.
struct Place {
  const BusConfig* bus = nullptr;
  std::string interface;
};

struct Running {
  std::string name;
  std::string interface;
  std::unique_ptr<sim::SimPort> port;
};

MonotonicTime monotonicNow() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return MonotonicTime{std::chrono::seconds{now.tv_sec} + std::chrono::nanoseconds{now.tv_nsec}};
}

std::string busNames(const RobotConfig& config) {
  std::string names;
  for (const auto& bus : config.buses) names += (names.empty() ? "" : ", ") + bus.name;
  return names;
}

Result<Place> placeOf(const RobotConfig& config, const std::string& argument) {
  const auto equals = argument.find('=');
  const std::string name = argument.substr(0, equals);
  const auto bus = std::find_if(config.buses.begin(), config.buses.end(),
                                [&name](const BusConfig& other) { return other.name == name; });
  if (bus == config.buses.end()) {
    std::vector<std::string_view> names;
    names.reserve(config.buses.size());
    for (const auto& each : config.buses) names.emplace_back(each.name);
    return fail("--bus: " + config.file + " has no bus '" + name + "'; it has: " + busNames(config) +
                didYouMean(name, names));
  }
  Place place{&*bus, equals == std::string::npos ? bus->interface : argument.substr(equals + 1)};
  if (place.interface.empty()) {
    return fail("--bus: bus '" + name + "' has no interface in the file; name one: --bus " + name + "=vcan0");
  }
  return place;
}

Result<std::vector<Place>> choosePlaces(const RobotConfig& config,
                                        const std::vector<std::string>& arguments) {
  std::vector<Place> places;
  if (arguments.empty()) {
    for (const auto& bus : config.buses) {
      if (bus.type == BusType::kSocketCan) places.push_back({&bus, bus.interface});
    }
    if (places.empty()) {
      return fail(config.file +
                  " has no SocketCAN bus; put a simulated one on an interface: --bus NAME=vcan0");
    }
  }
  for (const auto& argument : arguments) {
    auto place = placeOf(config, argument);
    if (!place) return tl::unexpected(place.error());
    for (const Place& other : places) {
      if (other.bus != place->bus && other.interface != place->interface) continue;
      return fail("--bus " + argument + ": that bus or interface is named twice; each takes one --bus");
    }
    places.push_back(std::move(*place));
  }
  return places;
}

Result<Running> start(const Place& place, const Options& options) {
  sim::SimBusConfig config = simulatedBus(*place.bus);
  if (options.seed) config.seed = *options.seed;
  if (auto ok = sim::SimBus::check(config); !ok) return tl::unexpected(ok.error());
  // Feedback of two periods, so that a busy moment of the interface loses none.
  auto socket =
      openCanSocket(place.interface, {.frames_per_tick = 2 * static_cast<int>(config.drives.size())});
  if (!socket) return tl::unexpected(socket.error());
  return Running{place.bus->name, place.interface,
                 std::make_unique<sim::SimPort>(std::move(socket->fd), config, sim::Stamps::kKernel)};
}

Result<std::vector<Running>> startAll(const std::vector<Place>& places, const Options& options) {
  std::vector<Running> running;
  for (const Place& place : places) {
    auto started = start(place, options);
    if (!started) return fail("bus '" + place.bus->name + "': " + started.error().message);
    running.push_back(std::move(*started));
  }
  return running;
}

/// Expires every period, half a period off the whole periods of CLOCK_MONOTONIC: rc10d ticks 0.3 of one after
/// those, and feedback that raced with its tick would come now before and now after it.
Result<UniqueFd> makeTimer() {
  UniqueFd timer{::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)};
  if (!timer) return fail(systemError("timerfd_create"));
  const Duration now = monotonicNow().time_since_epoch();
  const itimerspec spec{.it_interval = toTimespec(kPeriod),
                        .it_value = toTimespec((now / kPeriod + 1) * kPeriod + kPeriod / 2)};
  if (::timerfd_settime(timer.get(), TFD_TIMER_ABSTIME, &spec, nullptr) != 0) {
    return fail(systemError("timerfd_settime"));
  }
  return timer;
}

/// From here on SIGINT and SIGTERM are only seen as something to read.
Result<void> run(std::vector<Running>& buses, int signals, const Options& options) {
  flushSubnormals();
  const auto timer = makeTimer();
  if (!timer) return tl::unexpected(timer.error());
  const auto end = monotonicNow() +
                   std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.duration_s));
  std::array<pollfd, 2> waited{pollfd{timer->get(), POLLIN, 0}, pollfd{signals, POLLIN, 0}};
  for (;;) {
    if (::poll(waited.data(), waited.size(), -1) < 0) {
      if (errno == EINTR) continue;
      return fail(systemError("poll"));
    }
    if (waited[1].revents != 0) return {};
    std::uint64_t expirations = 0;
    if (::read(timer->get(), &expirations, sizeof(expirations)) < 0) continue;
    if (options.duration_s > 0.0 && monotonicNow() >= end) return {};
    for (Running& bus : buses) {
      bus.port->step(monotonicNow());
      bus.port->sentAt(monotonicNow());
      if (bus.port->counters().error != ENODEV) continue;
      return fail("bus '" + bus.name + "': interface '" + bus.interface +
                  "' is gone; start rc10-sim again when it is back");
    }
  }
}

void printReady(const std::vector<Running>& buses) {
  std::string line;
  std::size_t motors = 0;
  for (const Running& bus : buses) {
    line += (line.empty() ? "" : ", ") + bus.name + " on " + bus.interface;
    motors += bus.port->bus().size();
  }
  std::printf("ready: %zu %s, %s\n", motors, motors == 1 ? "motor" : "motors", line.c_str());
  std::fflush(stdout);
}

void printSummary(const std::vector<Running>& buses) {
  for (const Running& bus : buses) {
    const auto& port = bus.port->counters();
    const auto& drives = bus.port->bus().counters();
    std::printf(
        "%s on %s: %llu frames read, %llu sent, %llu refused by the interface, %llu lost on purpose, "
        "%llu not made because rc10-sim was late\n",
        bus.name.c_str(), bus.interface.c_str(), static_cast<unsigned long long>(port.commands),
        static_cast<unsigned long long>(port.sent), static_cast<unsigned long long>(port.refused),
        static_cast<unsigned long long>(drives.lost), static_cast<unsigned long long>(drives.overslept));
  }
}

int complain(const Error& error, int exit_code) {
  std::fprintf(stderr, "rc10-sim: %s\n", error.message.c_str());
  return exit_code;
}

int simulate(const Options& options) {
  const ConfigOutcome loaded = loadRobotConfig(options.config);
  std::fputs(loaded.errorText().c_str(), stderr);
  if (!loaded.config) return kExitUsage;
  const auto places = choosePlaces(*loaded.config, options.buses);
  if (!places) return complain(places.error(), kExitUsage);
  const auto signals = makeSignals();
  if (!signals) return complain(signals.error(), kExitFailed);
  auto buses = startAll(*places, options);
  if (!buses) return complain(buses.error(), kExitFailed);
  printReady(*buses);
  if (auto ok = run(*buses, signals->get(), options); !ok) return complain(ok.error(), kExitFailed);
  printSummary(*buses);
  return kExitOk;
}

int parseAndSimulate(int argc, char** argv) {
  Options options;
  CLI::App app{"Simulates the motors of a robot on SocketCAN interfaces, until SIGINT or SIGTERM.",
               "rc10-sim"};
  app.add_option("-c,--config", options.config, "the robot's configuration file")->required();
  app.add_option("--bus", options.buses, "NAME[=INTERFACE]: only this bus, on this interface (repeatable)")
      ->take_all();
  app.add_option("--seed", options.seed, "of what is random; default: each bus's own sim: {seed: …}");
  app.add_option("--duration", options.duration_s, "seconds to run")->check(CLI::Range(0.001, 1e6));
  app.set_version_flag("--version", std::string("rc10-sim ") + kVersion);
  if (const auto ended = parseCommandLine(app, argc, argv)) return *ended;
  return simulate(options);
}

}  // namespace
}  // namespace rc10

int main(int argc, char** argv) { return rc10::runProgram("rc10-sim", rc10::parseAndSimulate, argc, argv); }
