#include <linux/can.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <string>

#include <CLI/CLI.hpp>

#include "app/text_table.hpp"
#include "bus/can_link_state.hpp"
#include "bus/can_socket.hpp"
#include "bus/frame_text.hpp"
#include "bus/wire_frame.hpp"
#include "client/json_line.hpp"
#include "client/quantity_text.hpp"
#include "link/interface_lock.hpp"
#include "survey/bus_survey.hpp"
#include "survey/harmless_queries.hpp"
#include "survey/scan_advice.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

using std::chrono::steady_clock;
using survey::Sighting;

// A question of 8 bytes and its answer take 0.3 ms at 1 Mbit/s; at 250 kbit/s they fit too.
constexpr Duration kBetweenQueries = std::chrono::milliseconds{2};
// The last one is answered by then.
constexpr Duration kAnswering = std::chrono::milliseconds{200};

struct ScanOptions {
  std::string interface;
  double listen_s = 2.0;
  bool listen_only = false;
};

// Rows for people: what one drive sends under several ids is one row.
struct Row {
  std::string ids;
  std::uint64_t frames = 0;
};
using Rows = std::map<std::pair<std::string, int>, Row>;

std::string nameOf(const DriveGuess& guess) {
  std::string name(guess.kind);
  if (guess.id != 0) name += " id " + std::to_string(guess.id);
  return guess.from_drive ? name : "commands for " + name;
}

std::string allNames(const Sighting& sighting) {
  std::string names;
  for (const auto& guess : sighting.guesses) names += (names.empty() ? "" : ", or ") + nameOf(guess);
  return names;
}

Rows rowsOf(const std::vector<Sighting>& sightings) {
  Rows rows;
  for (const auto& sighting : sightings) {
    if (sighting.guesses.empty() || sighting.ambiguous()) continue;
    for (const auto& guess : sighting.guesses) {
      auto& row = rows[{guess.from_drive ? std::string(guess.kind) : "commands: " + std::string(guess.kind),
                        guess.id}];
      row.ids += (row.ids.empty() ? "" : ", ") + idText(sighting.id);
      row.frames += sighting.frames;
    }
  }
  return rows;
}

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

void printSightingsText(const std::vector<Sighting>& sightings, const survey::Asking& asking) {
  const auto rows = rowsOf(sightings);
  TextTable table(
      {{"KIND"}, {"ID", TextTable::Align::kRight}, {"FRAMES", TextTable::Align::kRight}, {"FRAME IDS"}});
  for (const auto& [drive, row] : rows)
    table.add({drive.first,
               drive.second != 0 || drive.first == drive_kind::kVesc ? std::to_string(drive.second) : "",
               std::to_string(row.frames), row.ids});
  if (!rows.empty()) std::fputs(table.text().c_str(), stdout);
  for (const auto& sighting : sightings) {
    const auto advice = survey::adviceFor(sighting, sightings);
    const auto heard = idText(sighting.id) + ", " + std::to_string(sighting.frames) + " frames: ";
    if (sighting.guesses.empty())
      std::printf("unknown: %s%s\n", heard.c_str(), advice.c_str());
    else if (sighting.ambiguous())
      std::printf("ambiguous: %s%s. %s\n", heard.c_str(), allNames(sighting).c_str(), advice.c_str());
    else if (!advice.empty())
      std::printf("%s\n", advice.c_str());
  }
  for (const auto& advice : survey::adviceForBus(sightings, asking)) std::printf("%s\n", advice.c_str());
}

void printSightingsJson(const std::string& interface, const std::vector<Sighting>& sightings,
                        const survey::Asking& asking) {
  for (const auto& sighting : sightings) {
    client::Json guesses = client::Json::array();
    for (const auto& guess : sighting.guesses)
      guesses.push_back({{"kind", guess.kind}, {"id", guess.id}, {"from_drive", guess.from_drive}});
    const auto advice = survey::adviceFor(sighting, sightings);
    std::puts(client::lineOf({{"frame_id", sighting.id.value},
                              {"extended", sighting.id.extended},
                              {"frames", sighting.frames},
                              {"ambiguous", sighting.ambiguous()},
                              {"guesses", std::move(guesses)},
                              {"advice", advice.empty() ? client::Json(nullptr) : client::Json(advice)}})
                  .c_str());
  }
  std::puts(client::lineOf({{"interface", interface},
                            {"frame_ids", sightings.size()},
                            {"listen_only", asking.listen_only},
                            {"advice", survey::adviceForBus(sightings, asking)}})
                .c_str());
}

// Somebody else's frames in between would be wrong, and ours in theirs.
std::string heldBy(const std::string& interface) {
  const auto holder = link::holderOfInterface(interface);
  if (holder.empty()) return {};
  return interface + " is driven by " + holder +
         ": `rc10ctl stats` and `rc10ctl watch` show its drives; or stop it first: `sudo systemctl stop "
         "rc10d`";
}

ExitCode scan(const Global& global, const ScanOptions& options) {
  if (const auto held = heldBy(options.interface); !held.empty()) return complain({held}, ExitCode::kFailed);
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
      link::InterfaceLock::take(boundInterface(socket->fd.get()), options.interface, "none (rc10ctl scan)");
  if (!lock) return complain(lock.error(), ExitCode::kFailed);
  const auto start = steady_clock::now();
  Scanner scanner(std::move(*socket), options);
  if (const auto why = scanner.run(); !why.empty())
    return complain({options.interface + ": " + why + ": see `rc10ctl doctor`"}, ExitCode::kFailed);
  if (interrupted()) return complain({"interrupted: nothing is known yet"}, ExitCode::kFailed);
  const auto sightings = scanner.survey().sightings(steady_clock::now() - start);
  const survey::Asking asking{.listen_only = options.listen_only, .spared = scanner.spared()};
  if (global.json)
    printSightingsJson(options.interface, sightings, asking);
  else
    printSightingsText(sightings, asking);
  return ExitCode::kOk;
}

}  // namespace

void addScan(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ScanOptions>();
  auto* verb = app.add_subcommand(
      "scan", "which drives are on a CAN interface; moves none. Not while rc10d drives it");
  verb->add_option("interface", options->interface, "a CAN interface that is up")
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
