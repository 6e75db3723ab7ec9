#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "app/time.hpp"

namespace rc10 {

/// A colour by its parts, each 0 to 1.
struct Rgb {
  float red = 0.0F;
  float green = 0.0F;
  float blue = 0.0F;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// Pattern of the texts that colourOf() accepts, for keys of the configuration.
inline constexpr std::string_view kColourPattern =
    "black|white|red|amber|orange|yellow|green|cyan|blue|magenta|#[0-9a-fA-F]{6}";
inline constexpr std::string_view kColourWords =
    "black, white, red, amber, orange, yellow, green, cyan, blue, magenta, or \"#rrggbb\" in quotes";

/// Black for a text that is no colour.
[[nodiscard]] Rgb colourOf(std::string_view text) noexcept;

enum class LedPattern : std::uint8_t {
  kSteady,
  kBlink,    ///< One colour for half the period, the second for the other half.
  kBreathe,  ///< From the second colour to the first and back.
  kRun,      ///< A quarter of the strip in the first colour runs over the second.
};

/// Light of a strip as a function of time.
struct LedEffect {
  LedPattern pattern = LedPattern::kSteady;
  Rgb colour;
  Rgb second;
  Duration period{std::chrono::seconds{1}};  ///< Above 0.
};

/// The picture at `now`. Strips with equal effects are in step.
void paint(const LedEffect& effect, MonotonicTime now, std::span<Rgb> pixels) noexcept;

}  // namespace rc10
