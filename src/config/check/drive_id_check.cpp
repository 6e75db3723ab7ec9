#include "config/check/drive_id_check.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "config/check/drive_ids.hpp"
#include "drives/dji/dji_family.hpp"

namespace rc10 {
namespace {

using Drafts = std::vector<const MotorDraft*>;

const DjiModel& modelOf(const MotorDraft& motor) { return *findDjiModel(motor.config.settings.model); }

std::string namesOf(const Drafts& motors) {
  std::vector<std::string> names;
  for (const auto* motor : motors) names.push_back(nameOf(*motor));
  return listWords(names);
}

bool mixesFamilies(const Drafts& motors) {
  const bool first = isGM6020(modelOf(*motors.front()));
  return std::any_of(motors.begin(), motors.end(),
                     [first](const auto* motor) { return isGM6020(modelOf(*motor)) != first; });
}

class DriveIdCheck {
 public:
  DriveIdCheck(const std::vector<MotorDraft>& motors, Problems& problems) : problems_(problems) {
    for (const auto& motor : motors) {
      if (!motor.complete || motor.config.family != &djiFamily()) continue;
      const DjiMotorConfig dji = djiConfig(motor.config.settings);
      by_feedback_[feedbackId(dji)].push_back(&motor);
      by_command_[commandId(dji)].push_back(&motor);
    }
  }

  void run() {
    for (const auto& [id, motors] : by_feedback_) {
      if (motors.size() > 1) reportFeedback(id, motors);
    }
    for (const auto& [id, motors] : by_command_) {
      if (mixesFamilies(motors) && !allReported(motors)) reportCommand(id, motors);
    }
  }

 private:
  void reportFeedback(std::uint32_t id, const Drafts& motors) {
    reported_.insert(motors.begin(), motors.end());
    const auto& second = *motors[1];
    problems_.error(second.id_place, joinPath(second.path, "id"),
                    namesOf(motors) + (motors.size() == 2 ? " both" : " all") + " answer with " + idText(id) +
                        "; " + freeIds(motors));
  }

  void reportCommand(std::uint32_t id, const Drafts& motors) {
    const auto other_family = [&](const auto* motor) {
      return isGM6020(modelOf(*motor)) != isGM6020(modelOf(*motors.front()));
    };
    const auto& second = **std::find_if(motors.begin(), motors.end(), other_family);
    problems_.error(
        second.id_place, joinPath(second.path, "id"),
        namesOf(motors) + " read the command frame " + idText(id) +
            ", which holds either currents for C620 and C610 or voltages for GM6020; give the GM6020 an id "
            "of 5 to 7, or command: current");
  }

  /// "free for M3508: 4, 5 and 6": for each model among the motors.
  std::string freeIds(const Drafts& motors) const {
    std::map<const DjiModel*, DjiCommand> kinds;
    for (const auto* motor : motors) {
      const DjiMotorConfig dji = djiConfig(motor->config.settings);
      kinds.emplace(dji.model, dji.command);
    }
    std::vector<std::string> words;
    for (const DjiModel* model : djiModels()) {
      const auto kind = kinds.find(model);
      if (kind != kinds.end()) words.push_back(freeIdsFor(*model, kind->second));
    }
    return "give each its own: " + listWords(words, "; ");
  }

  std::string freeIdsFor(const DjiModel& model, DjiCommand command) const {
    std::vector<std::string> ids;
    for (int id = 1; id <= model.max_id; ++id) {
      const auto frame = by_command_.find(commandId(model, command, id));
      const bool frame_fits = frame == by_command_.end() ||
                              std::all_of(frame->second.begin(), frame->second.end(), [&](const auto* motor) {
                                return isGM6020(modelOf(*motor)) == isGM6020(model);
                              });
      if (frame_fits && by_feedback_.find(feedbackId(model, id)) == by_feedback_.end())
        ids.push_back(std::to_string(id));
    }
    const std::string name{model.name};
    return ids.empty() ? "no id is free for " + name : "free for " + name + ": " + listWords(ids);
  }

  bool allReported(const Drafts& motors) const {
    return std::all_of(motors.begin(), motors.end(),
                       [&](const auto* motor) { return reported_.count(motor) != 0; });
  }

  Problems& problems_;
  std::map<std::uint32_t, Drafts> by_feedback_;
  std::map<std::uint32_t, Drafts> by_command_;
  std::set<const MotorDraft*> reported_;
};

}  // namespace

void checkDriveIds(const std::vector<MotorDraft>& motors, Problems& problems) {
  DriveIdCheck{motors, problems}.run();
}

}  // namespace rc10
