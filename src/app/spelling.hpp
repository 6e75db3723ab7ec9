#pragma once

#include <algorithm>
#include <cctype>
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

namespace spelling_detail {

inline std::string inCapitals(std::string word) {
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word;
}

/// "rc10ctl set MOTOR MODE [VALUE]": what stands in its place, and the options that have to be given.
template <typename App>
std::string usageOf(const App& app) {
  std::string usage;
  for (const auto* each = &app; each != nullptr; each = each->get_parent())
    usage.insert(0, each->get_name() + (usage.empty() ? "" : " "));
  for (const auto* option : app.get_options()) {
    const std::string type = option->get_type_name();
    const bool own_type = type.find_first_of("=|:{") == std::string::npos || type == "NAME=NUMBER";
    if (!option->get_positional()) {
      if (option->get_required()) usage += " " + option->get_name() + " " + type;
      continue;
    }
    const bool generic = type.empty() || type == "TEXT" || type == "FLOAT" || type == "INT" || type == "UINT";
    std::string word = generic || !own_type ? inCapitals(option->get_single_name()) : type;
    if (option->get_expected_max() > 1) word += "...";
    usage += option->get_required() ? " " + word : " [" + word + "]";
  }
  return usage;
}

/// Whether CLI11 says so: its error has the name of the program, not of its kind.
inline bool isWordTooMany(std::string_view said) {
  return said.substr(0, said.find(" argument")) == "The following";
}

/// The parser's words about a number, or a word too many, as people say them.
inline std::string inWords(const std::string& kind, const std::string& said) {
  const auto colon = said.find(": ");
  if (colon == std::string::npos) return said;
  const std::string rest = said.substr(colon + 2);
  if (isWordTooMany(said)) return "one word too many: " + rest;
  const auto equals = rest.find(" = ");
  if (kind != "ConversionError" || equals == std::string::npos) return said;
  return rest.substr(0, equals) + ": '" + rest.substr(equals + 3) + "' is no number; units are not written";
}

}  // namespace spelling_detail

/// The mistake of a command line that `error` ended, and how it is written: "motor is required; usage:
/// `rc10ctl zero MOTOR [DEG]`".
template <typename App, typename Error>
[[nodiscard]] std::string usageError(const App& app, const Error& error, int argc, const char* const* argv) {
  using namespace spelling_detail;
  const auto verbs = app.get_subcommands();
  const App& verb = verbs.empty() ? app : *verbs.front();
  const std::string help =
      "; `" + app.get_name() + (verbs.empty() ? "" : " " + verb.get_name()) + " --help` has all";
  // "; did you mean enable?"
  if (const auto word = misspelt(app, argc, argv); !word.empty())
    return word + (word.back() == '?' ? help.substr(1) : help);
  std::string said = printable(inWords(error.get_name(), error.what()));
  if (verbs.empty() && error.get_name() == "RequiredError" && app.get_require_subcommand_min() > 0)
    return "say what to do, such as `" + app.get_name() + " " +
           app.get_subcommands([](const App*) { return true; }).front()->get_name() + "`" + help;
  if (!verbs.empty()) said += "; usage: `" + usageOf(verb) + "`";
  return said + help;
}

}  // namespace rc10
