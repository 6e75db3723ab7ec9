#include "app/nearest.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>

namespace rc10 {
namespace {

constexpr std::size_t kLongestKey = 64;  // No key is that long; keeps the work small for any input.

/// Capitals and hyphens are not what makes a name another one.
std::string plain(std::string_view name) {
  std::string text{name};
  for (char& c : text) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Insertions, deletions, replacements and swaps of neighbours between two words.
std::size_t editDistance(const std::string& a, const std::string& b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> distance((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return distance[i * width + j]; };
  for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = i;
  for (std::size_t j = 0; j <= b.size(); ++j) at(0, j) = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return distance.back();
}

/// The candidates that have more words behind these, often the unit: `track` of track_m.
std::vector<std::string_view> longer(const std::string& wanted,
                                     const std::vector<std::string_view>& candidates) {
  std::vector<std::string_view> found;
  for (const auto candidate : candidates) {
    if (plain(candidate).starts_with(wanted + "_")) found.push_back(candidate);
  }
  return found;
}

}  // namespace

std::string_view nearest(std::string_view typed, const std::vector<std::string_view>& candidates) {
  if (typed.empty() || typed.size() > kLongestKey) return {};
  const std::string wanted = plain(typed);
  std::string_view best;
  std::size_t best_distance = 1 + std::max<std::size_t>(1, wanted.size() / 3);
  for (const auto candidate : candidates) {
    const std::size_t distance = editDistance(wanted, plain(candidate));
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  // angle_min is angle_min_deg, not angle_pid.
  if (best_distance > 1) {
    if (const auto found = longer(wanted, candidates); found.size() == 1) return found.front();
  }
  return best;
}

std::string didYouMean(std::string_view typed, const std::vector<std::string_view>& candidates) {
  const auto meant = nearest(typed, candidates);
  if (meant.empty() && !typed.empty() && typed.size() <= kLongestKey) {
    const auto found = longer(plain(typed), candidates);
    if (found.size() == 2)
      return "; did you mean " + std::string{found[0]} + " or " + std::string{found[1]} + "?";
  }
  return meant.empty() ? std::string{} : "; did you mean " + std::string{meant} + "?";
}

}  // namespace rc10
