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

bool isAnsweredTo(CanId question, std::uint32_t drive) {
  const auto& families = builtInFamilies();
  return std::any_of(families.begin(), families.end(), [&](const FamilyEntry& entry) {
    if (entry.questions == nullptr || entry.questions->answer == nullptr) return false;
    const auto answer = entry.questions->answer(question);
    return answer && answer->extended && answer->value <= 0xFFFFU && (answer->value & 0xFFU) == drive;
  });
}

}  // namespace rc10::survey
