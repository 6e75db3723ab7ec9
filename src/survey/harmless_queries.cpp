#include "survey/harmless_queries.hpp"

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

}  // namespace rc10::survey
