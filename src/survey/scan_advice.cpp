#include "survey/scan_advice.hpp"

#include <algorithm>

#include "app/list_words.hpp"
#include "drives/families.hpp"

namespace rc10::survey {
namespace {

/// The drive that has certainly sent these frames.
const DriveGuess* certainOf(const Sighting& sighting) {
  if (sighting.guesses.empty() || sighting.ambiguous()) return nullptr;
  return &sighting.guesses.front();
}

bool speaks(const Sighting& sighting, const DriveGuess& drive) {
  return !sighting.ambiguous() &&
         std::any_of(sighting.guesses.begin(), sighting.guesses.end(), [&](const DriveGuess& guess) {
           return guess == drive && guess.from_drive && guess.silent.empty();
         });
}

void append(std::vector<std::string>& words, std::span<const std::string_view> more) {
  words.insert(words.end(), more.begin(), more.end());
}

/// Names of the drives that are asked; of those that may be silent otherwise; of families that only answer,
/// and are not asked.
struct ScanNames {
  std::vector<std::string> asked;
  std::vector<std::string> silent;
  std::vector<std::string> not_asked;
};

ScanNames scanNames() {
  ScanNames names;
  for (const auto& entry : builtInFamilies()) {
    if (entry.questions != nullptr) {
      append(names.asked, entry.questions->asked);
      append(names.silent, entry.questions->silent);
    } else if (!entry.only_answer.empty()) {
      names.not_asked.emplace_back(entry.only_answer);
    }
  }
  std::sort(names.not_asked.begin(), names.not_asked.end());
  return names;
}

}  // namespace

bool isSilent(const Sighting& sighting, const std::vector<Sighting>& all) {
  const DriveGuess* const drive = certainOf(sighting);
  if (drive == nullptr || drive->silent.empty() || !drive->from_drive) return false;
  return std::none_of(all.begin(), all.end(), [&](const Sighting& other) { return speaks(other, *drive); });
}

std::string adviceFor(const Sighting& sighting, const std::vector<Sighting>& all) {
  if (sighting.guesses.empty()) return "no family that rc10d knows";
  if (sighting.ambiguous()) return "Look at its label, or unplug it and scan again";
  if (!isSilent(sighting, all)) return {};
  const DriveGuess& drive = sighting.guesses.front();
  return std::string{drive.kind} + " id " + std::to_string(drive.id) +
         " answers but sends no status: " + std::string{drive.silent};
}

std::vector<std::string> adviceForBus(const std::vector<Sighting>& all, const Asking& asking) {
  std::vector<std::string> advice;
  if (all.empty()) {
    advice.emplace_back(
        "nothing was heard: check the drives' power, the wiring, the termination and the bit rate: `rc10ctl "
        "doctor`");
  }
  const ScanNames names = scanNames();
  for (const auto& drive : asking.spared) {
    advice.push_back("not all " + listWords(names.asked) + " ids were asked: " + drive +
                     ", would take the questions for commands");
  }
  advice.push_back(listWords(names.not_asked) +
                   " drives speak only when they are asked, and are not asked here: a question to one family "
                   "may be a command to another. Take their ids from their labels or tools.");
  if (asking.listen_only) {
    advice.push_back("Nothing was asked (--listen-only): " + listWords(names.silent) + " may be silent too.");
  }
  return advice;
}

}  // namespace rc10::survey
