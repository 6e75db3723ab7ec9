#include "survey/frame_words.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "drives/families.hpp"

namespace rc10::survey {

std::string frameWords(const CanFrame& frame, std::span<const std::string> models, bool sent) {
  if (frame.type != FrameType::kData) return {};
  std::vector<std::string> readings;
  for (const auto& entry : builtInFamilies()) {
    if (entry.word == nullptr) continue;
    for (const auto model : entry.family->models()) {
      if (std::find(models.begin(), models.end(), model) == models.end()) continue;
      auto words = entry.word(frame, model, sent);
      if (words.empty()) continue;
      words.insert(0, " ").insert(0, entry.family->name());
      if (std::find(readings.begin(), readings.end(), words) == readings.end())
        readings.push_back(std::move(words));
    }
  }
  std::string text;
  for (const auto& words : readings) text += (text.empty() ? "" : " or ") + words;
  return text;
}

}  // namespace rc10::survey
