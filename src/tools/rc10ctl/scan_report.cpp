#include "scan_report.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <span>
#include <utility>

#include "app/printable.hpp"
#include "app/text_table.hpp"
#include "bus/frame_text.hpp"
#include "client/json_line.hpp"
#include "client/sighting_json.hpp"
#include "drives/recogniser.hpp"
#include "survey/link_sighting.hpp"

namespace rc10::ctl {
namespace {

// Rows for people: what one drive sends under several ids is one row.
struct Row {
  std::string ids;
  std::string motor;
  std::int64_t frames = 0;
};
using Rows = std::map<std::pair<std::string, int>, Row>;

std::span<const link::ScanGuess> guessesOf(const link::Sighting& sighting) {
  return std::span(sighting.guesses)
      .first(std::min<std::size_t>(sighting.guess_count, link::kMaxScanGuesses));
}

std::string idOf(const link::Sighting& sighting) {
  return idText({sighting.frame_id, sighting.extended != 0});
}

// The file says which of several it is.
bool isAmbiguous(const link::Sighting& sighting) {
  const auto guesses = guessesOf(sighting);
  return sighting.ambiguous != 0 && std::all_of(guesses.begin(), guesses.end(), [](const auto& guess) {
           return guess.motor.view().empty() || guess.collides != 0;
         });
}

std::string allNames(const link::Sighting& sighting) {
  std::string names;
  for (const auto& guess : guessesOf(sighting))
    names += (names.empty() ? "" : ", or ") + printable(survey::nameOf(guess));
  return names;
}

std::string motorOf(const link::ScanGuess& guess) {
  const auto motor = printable(guess.motor.view());
  if (guess.from_drive == 0) return {};
  if (motor.empty()) return "not in the file";
  return guess.collides != 0 ? "collides with " + motor : motor;
}

Rows rowsOf(const std::vector<link::Sighting>& sightings) {
  Rows rows;
  for (const auto& sighting : sightings) {
    if (isAmbiguous(sighting)) continue;
    for (const auto& guess : guessesOf(sighting)) {
      if (sighting.ambiguous != 0 && guess.motor.view().empty()) continue;
      const auto kind = printable(guess.kind.view());
      auto& row = rows[{guess.from_drive != 0 ? kind : "commands: " + kind, guess.id}];
      row.ids += (row.ids.empty() ? "" : ", ") + idOf(sighting);
      row.motor = motorOf(guess);
      row.frames += sighting.frames;
    }
  }
  return rows;
}

void printText(const ScanReport& report) {
  const auto rows = rowsOf(report.sightings);
  TextTable table({{"KIND"},
                   {"ID", TextTable::Align::kRight},
                   {"MOTOR"},
                   {"FRAMES", TextTable::Align::kRight},
                   {"FRAME IDS"}});
  for (const auto& [drive, row] : rows)
    table.add({drive.first,
               drive.second != 0 || drive.first == drive_kind::kVesc ? std::to_string(drive.second) : "",
               report.robot.empty() ? "" : row.motor, std::to_string(row.frames), row.ids});
  if (!rows.empty()) std::fputs(table.text().c_str(), stdout);
  for (const auto& sighting : report.sightings) {
    const auto advice = printable(sighting.advice.view());
    const auto heard = idOf(sighting) + ", " + std::to_string(sighting.frames) + " frames: ";
    if (sighting.guess_count == 0)
      std::printf("unknown: %s%s\n", heard.c_str(), advice.c_str());
    else if (isAmbiguous(sighting))
      std::printf("ambiguous: %s%s. %s\n", heard.c_str(), allNames(sighting).c_str(), advice.c_str());
    else if (!advice.empty() && sighting.ambiguous == 0)
      std::printf("%s\n", advice.c_str());
  }
  for (const auto& advice : report.advice) std::printf("%s\n", printable(advice).c_str());
}

void printJson(const ScanReport& report) {
  for (const auto& sighting : report.sightings)
    std::puts(client::lineOf(client::sightingJson(sighting)).c_str());
  std::puts(
      client::lineOf({{"interface", report.interface},
                      {"robot", report.robot.empty() ? client::Json(nullptr) : client::Json(report.robot)},
                      {"frame_ids", report.sightings.size()},
                      {"listen_only", report.listen_only},
                      {"advice", report.advice}})
          .c_str());
}

}  // namespace

void print(const Global& global, const ScanReport& report) {
  global.json ? printJson(report) : printText(report);
}

std::vector<std::string> linesOf(std::string_view message) {
  std::vector<std::string> lines;
  for (;;) {
    const auto end = message.find('\n');
    lines.emplace_back(message.substr(0, end));
    if (end == std::string_view::npos) return lines;
    message.remove_prefix(end + 1);
  }
}

}  // namespace rc10::ctl
