#include "client/sparkline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rc10::client {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kBlocks{"\u2581", "\u2582", "\u2583", "\u2584", "\u2585", "\u2586", "\u2587", "\u2588"};
constexpr std::array kAscii{"_", ".", ":", "-", "=", "+", "*", "#"};
static_assert(kBlocks.size() == kAscii.size());

}  // namespace

void Sparkline::add(double value) {
  values_.push_back(std::isfinite(value) ? value : kNone);
  while (values_.size() > width_) values_.pop_front();
}

// std::fmin and std::fmax pass over NaN.
double Sparkline::lowest() const noexcept {
  double lowest = kNone;
  for (const double value : values_) lowest = std::fmin(lowest, value);
  return lowest;
}

double Sparkline::highest() const noexcept {
  double highest = kNone;
  for (const double value : values_) highest = std::fmax(highest, value);
  return highest;
}

double Sparkline::newest() const noexcept { return values_.empty() ? kNone : values_.back(); }

std::string Sparkline::text(bool blocks) const {
  const auto& marks = blocks ? kBlocks : kAscii;
  const double low = lowest();
  const double range = highest() - low;
  std::string text;
  for (const double value : values_) {
    if (std::isnan(value)) {
      text += ' ';
      continue;
    }
    // A signal that stands still is a line in the middle.
    const double share = range > 0.0 ? (value - low) / range : 0.5;
    const auto level = static_cast<std::size_t>(share * static_cast<double>(marks.size()));
    text += marks[std::min(level, marks.size() - 1)];
  }
  return text;
}

}  // namespace rc10::client
