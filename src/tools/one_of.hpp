#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/nearest.hpp"
#include "app/printable.hpp"

namespace rc10 {

/// For a word that is one of a few.
[[nodiscard]] inline CLI::Validator oneOf(const std::vector<std::string>& words) {
  std::string list;
  for (const auto& word : words) list += (list.empty() ? "" : ",") + word;
  return CLI::Validator(
      [words, list](std::string& word) {
        if (std::find(words.begin(), words.end(), word) != words.end()) return std::string{};
        return "'" + printable(word) + "' is not one of " + list +
               didYouMean(word, {words.begin(), words.end()});
      },
      "{" + list + "}");
}

}  // namespace rc10
