#include "app/mode_words.hpp"

#include <vector>

#include "app/list_words.hpp"
#include "app/vocabulary.hpp"

namespace rc10 {

std::string modeWords(ModeSet modes, std::string_view last_joint) {
  std::vector<std::string> words;
  for (int i = 0; i < kControlModeCount; ++i) {
    const auto mode = static_cast<ControlMode>(i);
    if (modes.contains(mode)) words.emplace_back(toString(mode));
  }
  return listWords(words, last_joint);
}

}  // namespace rc10
