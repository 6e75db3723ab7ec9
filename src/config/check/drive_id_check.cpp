#include "config/check/drive_id_check.hpp"

#include <string>

#include "config/motor_families.hpp"

namespace rc10 {
namespace {

void checkFamily(const MotorFamily& family, const std::vector<MotorDraft>& motors, Problems& problems) {
  std::vector<const MotorDraft*> drafts;
  std::vector<MotorSettings> settings;
  for (const auto& motor : motors) {
    if (!motor.complete || motor.config.family != &family) continue;
    drafts.push_back(&motor);
    settings.push_back(motor.config.settings);
  }
  for (const auto& conflict : family.idJudge()(settings)) {
    std::vector<std::string> names;
    names.reserve(conflict.motors.size());
    for (const auto place : conflict.motors) names.push_back(nameOf(*drafts[place]));
    const MotorDraft& blamed = *drafts[conflict.blamed];
    problems.error(blamed.id_place, joinPath(blamed.path, "id"), listWords(names) + " " + conflict.text);
  }
}

}  // namespace

void checkDriveIds(const std::vector<MotorDraft>& motors, Problems& problems) {
  for (const auto& entry : motorFamilies()) {
    if (entry.family->idJudge() != nullptr) checkFamily(*entry.family, motors, problems);
  }
}

}  // namespace rc10
