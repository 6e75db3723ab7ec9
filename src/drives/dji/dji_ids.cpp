#include "drives/dji/dji_ids.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "app/list_words.hpp"
#include "bus/frame_text.hpp"
#include "drives/dji/dji_model.hpp"

namespace rc10 {
namespace {

/// C620 and C610 read one set of frames, GM6020 another: they never share a command frame.
[[nodiscard]] bool isGM6020(const DjiModel& model) noexcept { return &model == &kGM6020; }

class DjiIds {
  using Places = std::vector<std::size_t>;
  struct Drive {
    const DjiModel* model;
    int id;
    DjiCommand command;
  };

 public:
  explicit DjiIds(std::span<const MotorSettings> motors) {
    for (const auto& settings : motors) {
      const std::size_t place = drives_.size();
      const auto& drive = drives_.emplace_back(
          Drive{findDjiModel(settings.model), settings.id, djiSettings(settings.own).command});
      by_feedback_[djiFeedbackId(*drive.model, drive.id).value].push_back(place);
      by_command_[djiCommandId(*drive.model, drive.command, drive.id).value].push_back(place);
    }
  }

  [[nodiscard]] std::vector<IdConflict> conflicts() {
    std::vector<IdConflict> found;
    for (const auto& [id, places] : by_feedback_) {
      if (places.size() > 1) found.push_back(sameAnswer({id, false}, places));
    }
    for (const auto& [id, places] : by_command_) {
      if (mixed(places) && !allReported(places)) found.push_back(sameCommand({id, false}, places));
    }
    return found;
  }

 private:
  [[nodiscard]] const DjiModel& modelOf(std::size_t place) const noexcept { return *drives_[place].model; }
  [[nodiscard]] bool mixed(const Places& places) const {
    return std::any_of(places.begin(), places.end(), [&](std::size_t place) {
      return isGM6020(modelOf(place)) != isGM6020(modelOf(places.front()));
    });
  }
  [[nodiscard]] bool allReported(const Places& places) const {
    return std::all_of(places.begin(), places.end(),
                       [&](std::size_t place) { return reported_.count(place) != 0; });
  }

  [[nodiscard]] IdConflict sameAnswer(CanId id, const Places& places) {
    reported_.insert(places.begin(), places.end());
    return {.motors = places,
            .blamed = places[1],
            .text = (places.size() == 2 ? "both" : "all") + std::string{" answer with "} + idText(id) + "; " +
                    freeIds(places)};
  }

  [[nodiscard]] IdConflict sameCommand(CanId id, const Places& places) const {
    const auto second = std::find_if(places.begin(), places.end(), [&](std::size_t place) {
      return isGM6020(modelOf(place)) != isGM6020(modelOf(places.front()));
    });
    return {
        .motors = places,
        .blamed = *second,
        .text = "read the command frame " + idText(id) +
                ", which holds either currents for C620 and C610 or voltages for GM6020; give the GM6020 an "
                "id of 5 to 7, or command: current"};
  }

  /// "free for M3508: 4, 5 and 6": for each model among the motors.
  [[nodiscard]] std::string freeIds(const Places& places) const {
    std::map<const DjiModel*, DjiCommand> kinds;
    for (const auto place : places) kinds.emplace(drives_[place].model, drives_[place].command);
    std::vector<std::string> words;
    for (const DjiModel* model : djiModels()) {
      const auto kind = kinds.find(model);
      if (kind != kinds.end()) words.push_back(freeIdsFor(*model, kind->second));
    }
    return "give each its own: " + listWords(words, "; ");
  }

  [[nodiscard]] std::string freeIdsFor(const DjiModel& model, DjiCommand command) const {
    std::vector<std::string> ids;
    for (int id = 1; id <= model.max_id; ++id) {
      const auto frame = by_command_.find(djiCommandId(model, command, id).value);
      const bool frame_fits = frame == by_command_.end() ||
                              std::all_of(frame->second.begin(), frame->second.end(), [&](std::size_t place) {
                                return isGM6020(modelOf(place)) == isGM6020(model);
                              });
      if (frame_fits && by_feedback_.find(djiFeedbackId(model, id).value) == by_feedback_.end())
        ids.push_back(std::to_string(id));
    }
    const std::string name{model.name};
    return ids.empty() ? "no id is free for " + name : "free for " + name + ": " + listWords(ids);
  }

  std::vector<Drive> drives_;
  std::map<std::uint32_t, Places> by_feedback_;
  std::map<std::uint32_t, Places> by_command_;
  std::set<std::size_t> reported_;
};

}  // namespace

std::vector<IdConflict> djiIdConflicts(std::span<const MotorSettings> motors) {
  return DjiIds{motors}.conflicts();
}

}  // namespace rc10
