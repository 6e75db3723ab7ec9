#include "app/list_words.hpp"

#include <cstddef>

namespace rc10 {

std::string listWords(const std::vector<std::string>& words, std::string_view last_joint) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) list += i + 1 == words.size() ? std::string{last_joint} : std::string{", "};
    list += words[i];
  }
  return list;
}

}  // namespace rc10
