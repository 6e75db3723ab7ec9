#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace rc10 {

/// A key of the configuration that only one family's motors have, or one type of module. Names end with their
/// unit.
struct OwnKey {
  enum class Kind : std::uint8_t {
    kNumber,
    kInteger,
    kFlag,
    kChoice,
    // For modules only:
    kText,     ///< As `pattern` says; without one, of 1 to 128 characters.
    kMotor,    ///< The name of a motor.
    kSection,  ///< A map with `keys`.
    kRows,     ///< A list of such maps, from `min` to `max` of them.
  };
  std::string_view name;
  Kind kind = Kind::kNumber;
  std::string_view unit{};
  double min = 0.0;
  double max = 0.0;
  bool above_min = false;  ///< The minimum itself is not allowed.
  std::span<const std::string_view> choices{};
  std::string_view default_text{};  ///< As it would be written; empty: `required`, or what `about` says.
  bool required = false;
  std::string_view about;  ///< For people; one key of one name says the same in every family.
  std::span<const OwnKey> keys{};
  std::string_view pattern{};  ///< Pattern of the whole text, common to ECMAScript and POSIX extended.
  std::string_view words{};    ///< The pattern in words: completes "use ..."; empty: the pattern itself.
};

}  // namespace rc10
