#include "config/yaml/problem.hpp"

#include <algorithm>
#include <tuple>

#include "app/printable.hpp"

namespace rc10 {
namespace {

auto order(const ConfigProblem& problem) { return std::tie(problem.place.line, problem.place.column); }

std::vector<ConfigProblem> inFileOrder(std::vector<ConfigProblem> problems) {
  std::stable_sort(problems.begin(), problems.end(),
                   [](const auto& a, const auto& b) { return order(a) < order(b); });
  std::vector<ConfigProblem> kept;
  for (auto& problem : problems) {
    const auto same = [&](const auto& other) {
      return order(other) == order(problem) && other.text == problem.text;
    };
    if (std::none_of(kept.rbegin(), kept.rend(), same)) kept.push_back(std::move(problem));
  }
  return kept;
}

}  // namespace

std::string toString(const ConfigProblem& problem, std::string_view kind) {
  std::string text = problem.file;
  if (problem.place.line > 0) {
    text += ":" + std::to_string(problem.place.line) + ":" + std::to_string(problem.place.column);
  }
  text += ": ";
  text += kind;
  if (!problem.path.empty()) text += problem.path + ": ";
  return text + problem.text;
}

void Problems::error(SourcePlace place, std::string path, std::string text) {
  if (!full()) errors_.push_back({file_, place, std::move(path), std::move(text)});
}

void Problems::warning(SourcePlace place, std::string path, std::string text) {
  if (warnings_.size() < kMost) warnings_.push_back({file_, place, std::move(path), std::move(text)});
}

bool Problems::hasErrorsIn(std::string_view path) const noexcept {
  return std::any_of(errors_.begin(), errors_.end(), [path](const ConfigProblem& problem) {
    const std::string_view at = problem.path;
    if (path.empty() || at.size() == path.size()) return at == path;
    return at.starts_with(path) && (at[path.size()] == '.' || at[path.size()] == '[');
  });
}

std::vector<ConfigProblem> Problems::errors() const {
  auto sorted = inFileOrder(errors_);
  if (full()) sorted.push_back({file_, {}, "", "more problems than can be listed; mend these first"});
  return sorted;
}

std::vector<ConfigProblem> Problems::warnings() const { return inFileOrder(warnings_); }

std::string joinPath(std::string_view path, std::string_view key) {
  return path.empty() ? excerpt(key) : std::string{path} + "." + excerpt(key);
}

std::string joinPath(std::string_view path, std::size_t index) {
  return std::string{path} + "[" + std::to_string(index) + "]";
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kMostShown = 48;
  std::size_t end = std::min(text.size(), kMostShown);
  // No half character.
  while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return printable(text.substr(0, end)) + (end < text.size() ? "..." : "");
}

std::string inQuotes(std::string_view text) { return "'" + excerpt(text) + "'"; }

}  // namespace rc10
