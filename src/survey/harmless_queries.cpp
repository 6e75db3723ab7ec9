#include "survey/harmless_queries.hpp"

#include <algorithm>

#include "drives/families.hpp"

namespace rc10::survey {

std::vector<CanFrame> harmlessQueries() {
  std::vector<CanFrame> queries;
  for (const auto& entry : builtInFamilies()) {
    if (entry.questions == nullptr) continue;
    const auto frames = entry.questions->frames();
    queries.insert(queries.end(), frames.begin(), frames.end());
  }
  return queries;
}

bool isAnsweredTo(CanId question, CanId drives) {
  const auto is_packet = [](CanId id) { return id.extended && id.value <= 0xFFFFU; };
  if (!is_packet(drives)) return false;
  const auto families = builtInFamilies();
  return std::any_of(families.begin(), families.end(), [&](const FamilyEntry& entry) {
    if (entry.questions == nullptr || entry.questions->answer == nullptr) return false;
    const auto answer = entry.questions->answer(question);
    return answer && is_packet(*answer) && ((answer->value ^ drives.value) & 0xFFU) == 0;
  });
}

}  // namespace rc10::survey
