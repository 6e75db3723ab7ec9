#include "module/led_effect.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>

#include "app/units.hpp"

namespace rc10 {
namespace {

constexpr Rgb fromHex(std::uint32_t hex) noexcept {
  const auto part = [hex](unsigned shift) { return static_cast<float>((hex >> shift) & 0xFFU) / 255.0F; };
  return {part(16), part(8), part(0)};
}

// As they look on an LED, where green is brighter than on a screen.
constexpr std::array<std::pair<std::string_view, std::uint32_t>, 10> kNamed{{{"black", 0x000000},
                                                                             {"white", 0xFFFFFF},
                                                                             {"red", 0xFF0000},
                                                                             {"amber", 0xFF6000},
                                                                             {"orange", 0xFF3000},
                                                                             {"yellow", 0xFFA000},
                                                                             {"green", 0x00FF00},
                                                                             {"cyan", 0x00FFFF},
                                                                             {"blue", 0x0000FF},
                                                                             {"magenta", 0xFF00FF}}};

constexpr Rgb mixed(const Rgb& from, const Rgb& to, float part) noexcept {
  return {from.red + (to.red - from.red) * part, from.green + (to.green - from.green) * part,
          from.blue + (to.blue - from.blue) * part};
}

// Squared: the eye sees half the brightness at a fifth of the light.
float breath(float phase) noexcept {
  const float swing = 0.5F - 0.5F * std::cos(static_cast<float>(kRadPerTurn) * phase);
  return swing * swing;
}

}  // namespace

Rgb colourOf(std::string_view text) noexcept {
  if (text.starts_with('#')) {
    std::uint32_t hex = 0;
    (void)std::from_chars(text.data() + 1, text.data() + text.size(), hex, 16);
    return fromHex(hex);
  }
  const auto* found =
      std::find_if(kNamed.begin(), kNamed.end(), [text](const auto& named) { return named.first == text; });
  return found != kNamed.end() ? fromHex(found->second) : Rgb{};
}

void paint(const LedEffect& effect, MonotonicTime now, std::span<Rgb> pixels) noexcept {
  const Duration since = now.time_since_epoch() % effect.period;
  const float phase = seconds(since) / seconds(effect.period);
  switch (effect.pattern) {
    case LedPattern::kSteady: std::fill(pixels.begin(), pixels.end(), effect.colour); return;
    case LedPattern::kBlink:
      std::fill(pixels.begin(), pixels.end(), since < effect.period / 2 ? effect.colour : effect.second);
      return;
    case LedPattern::kBreathe:
      std::fill(pixels.begin(), pixels.end(), mixed(effect.second, effect.colour, breath(phase)));
      return;
    case LedPattern::kRun: break;
  }
  std::fill(pixels.begin(), pixels.end(), effect.second);
  const auto head = static_cast<std::size_t>(phase * static_cast<float>(pixels.size()));
  const std::size_t length = std::max<std::size_t>(pixels.size() / 4, 1);
  for (std::size_t i = 0; i < std::min(length, pixels.size()); ++i)
    pixels[(head + i) % pixels.size()] = effect.colour;
}

}  // namespace rc10
