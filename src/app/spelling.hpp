#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "app/nearest.hpp"
#include "app/printable.hpp"

/// Words of a command line that no program knows, with the word that was meant. Templates of CLI::App: the
/// layer app, which others build on, does not need CLI11.
namespace rc10 {

namespace spelling_detail {

template <typename App>
std::vector<std::string> optionsOf(const App& app) {
  std::vector<std::string> names;
  for (const auto* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

inline std::string unknown(const char* what, std::string_view word, const std::vector<std::string>& known) {
  return std::string{"there is no "} + what + " '" + printable(word) + "'" +
         didYouMean(word, {known.begin(), known.end()});
}

/// For "check" where there is --check.
template <typename App>
std::string meantOption(const App& app, std::string_view word) {
  const auto known = optionsOf(app);
  return didYouMean("--" + std::string{word}, {known.begin(), known.end()});
}

}  // namespace spelling_detail

/// "there is no verb 'enabel'; did you mean enable?" for the first verb or option that `app` does not have;
/// empty if it has them all.
template <typename App>
[[nodiscard]] std::string misspelt(const App& app, int argc, const char* const* argv) {
  using namespace spelling_detail;
  const auto verbs = app.get_subcommands([](const App*) { return true; });
  const App* verb = nullptr;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--") break;
    if (word.substr(0, 2) == "--") {
      const std::string name{word.substr(0, word.find('='))};
      const auto* option = app.get_option_no_throw(name);
      if (option == nullptr && verb != nullptr) option = verb->get_option_no_throw(name);
      if (option == nullptr) {
        auto known = optionsOf(app);
        if (verb != nullptr) {
          const auto own = optionsOf(*verb);
          known.insert(known.end(), own.begin(), own.end());
        }
        return unknown("option", name, known);
      }
      // The next word is its value.
      if (option->get_items_expected_max() != 0 && word.find('=') == std::string_view::npos) ++i;
    } else if (verbs.empty() && word.substr(0, 1) != "-") {
      const auto meant = meantOption(app, word);
      if (!meant.empty()) return "there is no verb '" + printable(word) + "'" + meant;
    } else if (verb == nullptr && word.substr(0, 1) != "-") {
      std::vector<std::string> names;
      for (const auto* each : verbs) {
        names.push_back(each->get_name());
        if (names.back() == word) verb = each;
      }
      if (verb == nullptr) return unknown("verb", word, names);
    }
  }
  return {};
}

}  // namespace rc10
