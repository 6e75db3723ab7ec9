#include <linux/can.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>

#include <CLI/CLI.hpp>

#include "app/printable.hpp"
#include "bus/can_link_state.hpp"
#include "bus/can_socket.hpp"
#include "bus/wire_frame.hpp"
#include "client/request_call.hpp"
#include "link/interface_lock.hpp"
#include "scan_report.hpp"
#include "survey/bus_survey.hpp"
#include "survey/harmless_queries.hpp"
#include "survey/link_sighting.hpp"
#include "survey/scan_advice.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

using std::chrono::steady_clock;

// A question of 8 bytes and its answer take 0.3 ms at 1 Mbit/s; at 250 kbit/s they fit too.
constexpr Duration kBetweenQueries = std::chrono::milliseconds{2};
// The last one is answered by then.
constexpr Duration kAnswering = std::chrono::milliseconds{200};

// The questions, at the pace of a slow and busy bus.
constexpr Duration kAskingOfRc10d = std::chrono::seconds{30};
// Its name as the holder of an interface.
constexpr const char* kScanHolder = "none (rc10ctl scan)";

struct ScanOptions {
  std::string interface;
  double listen_s = 2.0;
  bool listen_only = false;
};

class Scanner {
 public:
  Scanner(CanSocket socket, const ScanOptions& options) : socket_(std::move(socket)), options_(options) {}

  // Empty, or what went wrong.
  std::string run() {
    auto why = listen(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options_.listen_s)));
    if (options_.listen_only) return why;
    for (const auto& query : survey::harmlessQueries()) {
      if (!why.empty() || interrupted()) return why;
      if (auto drive = survey_.commandedBy(query); !drive.empty()) {
        spared_.insert(std::move(drive));
        continue;
      }
      why = send(query);
      if (why.empty()) why = listen(kBetweenQueries);
    }
    return why.empty() ? listen(kAnswering) : why;
  }

  [[nodiscard]] const survey::BusSurvey& survey() const noexcept { return survey_; }
  /// Drives to which some questions would have been commands.
  [[nodiscard]] const std::set<std::string>& spared() const noexcept { return spared_; }

 private:
  std::string listen(Duration time) {
    const auto end = steady_clock::now() + time;
    for (auto now = steady_clock::now(); now < end && !interrupted(); now = steady_clock::now()) {
      pollfd entry{.fd = socket_.fd.get(), .events = POLLIN, .revents = 0};
      const auto wait = std::chrono::ceil<std::chrono::milliseconds>(end - now).count();
      if (::poll(&entry, 1, static_cast<int>(wait)) <= 0) continue;
      for (;;) {
        canfd_frame wire{};
        const auto size = ::recv(socket_.fd.get(), &wire, sizeof wire, MSG_DONTWAIT);
        if (size < 0 && (errno == EAGAIN || errno == EINTR)) break;
        if (size < 0) return std::strerror(errno);
        CanFrame frame;
        if (decodeFrame(wire, static_cast<std::size_t>(size), frame)) survey_.take(frame);
      }
    }
    return {};
  }

  // A queue that is full is a bus on which nobody acknowledges: said by what is not found.
  std::string send(const CanFrame& frame) {
    canfd_frame wire{};
    const auto size = encodeFrame(frame, wire);
    if (::send(socket_.fd.get(), &wire, size, MSG_DONTWAIT) >= 0 || errno == ENOBUFS || errno == EAGAIN)
      return {};
    return std::strerror(errno);
  }

  CanSocket socket_;
  const ScanOptions& options_;
  survey::BusSurvey survey_;
  std::set<std::string> spared_;
};

// rc10d asks on its own bus: somebody else's frames in between would be wrong, and ours in theirs.
ExitCode scanThroughRc10d(const Global& global, const ScanOptions& options, LinkClient& rc10d) {
  link::Request request;
  request.operation = toString(Operation::kScan);
  request.target = options.interface;
  request.values[request.value_count++] = {.name = std::string_view{"listen_s"}, .value = options.listen_s};
  request.values[request.value_count++] = {.name = std::string_view{"listen_only"},
                                           .value = options.listen_only ? 1.0 : 0.0};
  ScanReport report{.interface = options.interface, .listen_only = options.listen_only};
  const auto patience =
      std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.listen_s)) + kAskingOfRc10d;
  link::Sighting sighting;
  const auto response = RequestCall(rc10d, kClientName)
                            .call(
                                request, patience,
                                [&](auto datagram) {
                                  if (link::open(datagram, sighting)) report.sightings.push_back(sighting);
                                },
                                interrupted);
  if (!response) return complain(response.error(), ExitCode::kFailed);
  auto lines = linesOf(response->message.view());
  if (response->status != link::ResponseStatus::kOk)
    return complain({printable(response->message.view())}, ExitCode::kFailed);
  report.robot = std::string{rc10d.welcome().robot.view()};
  report.advice.assign(lines.begin() + 1, lines.end());
  print(global, report);
  return ExitCode::kOk;
}

// "robot 'hero' (rc10d, pid 123)", of a bus that an rc10d drives; another scan is none.
std::string driverOf(const std::string& interface) {
  auto holder = link::holderOfInterface(interface);
  return holder.find(kScanHolder) == std::string::npos ? holder : std::string{};
}

bool hasBus(const LinkClient& rc10d, std::string_view bus) {
  const auto& welcome = rc10d.welcome();
  const auto motors =
      std::span(welcome.motors).first(std::min<std::size_t>(welcome.motor_count, link::kMaxMotors));
  return std::any_of(motors.begin(), motors.end(),
                     [bus](const auto& motor) { return motor.bus.view() == bus; });
}

// Its own bus, or the name of a bus that is no interface, such as a simulated one.
std::optional<ExitCode> tryRc10d(const Global& global, const ScanOptions& options) {
  const auto driver = driverOf(options.interface);
  if (driver.empty() && ::if_nametoindex(options.interface.c_str()) != 0) return std::nullopt;
  auto rc10d = connect(global);
  if (driver.empty())
    return rc10d && hasBus(*rc10d, options.interface)
               ? std::optional{scanThroughRc10d(global, options, *rc10d)}
               : std::nullopt;
  if (!rc10d)
    return complain({options.interface + " is driven by " + driver + ", and only it may ask there: " +
                     rc10d.error().message + "; or stop it first: `sudo systemctl stop rc10d`"},
                    ExitCode::kNoDaemon);
  return scanThroughRc10d(global, options, *rc10d);
}

ExitCode scan(const Global& global, const ScanOptions& options) {
  if (const auto done = tryRc10d(global, options)) return *done;
  auto socket = openCanSocket(options.interface, {.frames_per_tick = 8});
  if (!socket) return complain(socket.error(), ExitCode::kFailed);
  const auto link = readCanLink(options.interface);
  if (link && !link->up) {
    return complain({options.interface + " is down: `sudo ip link set " + options.interface + " up" +
                     (link->isController() ? " type can bitrate 1000000 restart-ms 0`" : "`")},
                    ExitCode::kFailed);
  }
  // An rc10d that starts meanwhile would be answered by what we asked.
  const auto lock =
      link::InterfaceLock::take(boundInterface(socket->fd.get()), options.interface, kScanHolder);
  if (!lock) return complain(lock.error(), ExitCode::kFailed);
  const auto start = steady_clock::now();
  Scanner scanner(std::move(*socket), options);
  if (const auto why = scanner.run(); !why.empty())
    return complain({options.interface + ": " + why + ": see `rc10ctl doctor`"}, ExitCode::kFailed);
  if (interrupted()) return complain({"interrupted: nothing is known yet"}, ExitCode::kFailed);
  const auto all = scanner.survey().sightings(steady_clock::now() - start);
  const survey::Asking asking{.listen_only = options.listen_only, .spared = scanner.spared()};
  ScanReport report{.interface = options.interface,
                    .listen_only = options.listen_only,
                    .advice = survey::adviceForBus(all, asking)};
  for (const auto& sighting : all)
    report.sightings.push_back(survey::linkSighting(sighting, survey::adviceFor(sighting, all)));
  print(global, report);
  return ExitCode::kOk;
}

}  // namespace

void addScan(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ScanOptions>();
  auto* verb = app.add_subcommand(
      "scan", "which drives are on a CAN bus; moves none. Asks through rc10d where it drives the bus");
  verb->add_option("interface", options->interface, "a CAN interface that is up, or a bus of the robot")
      ->required()
      ->type_name("IFACE");
  verb->add_option("--seconds", options->listen_s, "how long to listen before asking")
      ->check(CLI::Range(0.5, 3600.0))
      ->type_name("S")
      ->capture_default_str();
  verb->add_flag("--listen-only", options->listen_only, "sends nothing");
  verb->callback(
      [&action, options] { action = [options](const Global& global) { return scan(global, *options); }; });
}

}  // namespace rc10::ctl
