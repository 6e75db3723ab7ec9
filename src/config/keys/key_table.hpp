#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace rc10 {

/// Kind of value under a key.
enum class ValueKind : std::uint8_t {
  kText,
  kInteger,
  kNumber,
  kBoolean,
  kTextList,       ///< A list of texts.
  kSection,        ///< A map with the keys of another table.
  kSectionList,    ///< A list of them.
  kNamedSections,  ///< A map from names to them.
  kTypedSections,  ///< A list of maps: which keys each may have, its `type` says.
};

/// Bounds of a number, or of how many items a list or map has.
struct Range {
  double min = 0.0;
  double max = 0.0;
  bool above_min = false;  ///< The minimum itself is not allowed.
};

/// Form of a text: for the loader, for messages and for editors.
struct TextForm {
  std::string_view
      pattern;             ///< Pattern of the whole text: what ECMAScript and POSIX extended have in common.
  std::string_view words;  ///< Completes "use ...".
};

/// Condition of a key that exists for some motors only.
enum Need : std::uint16_t {
  kNeedsCurrent = 1U << 0U,        ///< The drive is commanded in amperes.
  kNeedsVoltage = 1U << 1U,        ///< The drive is commanded in volts.
  kNeedsIncremental = 1U << 2U,    ///< The velocity loop is of type incremental.
  kNeedsPosition = 1U << 3U,       ///< The velocity loop is of type position.
  kNeedsAbsolute = 1U << 4U,       ///< The encoder sits on the output shaft.
  kNeedsTemperature = 1U << 5U,    ///< The drive reports its temperature.
  kNeedsHostLoops = 1U << 6U,      ///< Its loops run on the host.
  kNeedsUnasked = 1U << 7U,        ///< It speaks without being asked.
  kNeedsOwnFrames = 1U << 8U,      ///< It shares its command frames with no other.
  kNeedsSignedCurrent = 1U << 9U,  ///< It reports a current with the sign of its torque.
  kNeedsScaledSpeed = 1U << 10U,   ///< It reports its speed as a share of a range.
  kNeedsAngle = 1U << 11U,         ///< It reports an angle, or what one follows from.
  kNeedsSeenLimit = 1U << 12U,     ///< Its current is seen to be at the limit, in each mode.
  kNeedsHostVelocity = 1U << 13U,  ///< Its velocity loop runs on the host.
  kNeedsToldLimit = 1U << 14U,     ///< It can be told a limit of its effort.
};

struct Section;

/// The tables of a list whose items are of several types.
struct SectionTypes {
  std::vector<std::string_view> (*names)();
  const Section* (*find)(std::string_view type);  ///< nullptr: no such type.
};

/// One key of the configuration: everything the loader, the messages and the editors' schema know of it.
struct Key {
  std::string_view name{};
  ValueKind kind = ValueKind::kText;
  std::string_view unit{};         ///< Unit of numbers; the name of the key ends with it.
  Range range{};                   ///< Range of numbers, and of the number of items.
  const TextForm* form = nullptr;  ///< Form of texts, of those in kTextList, of the names in kNamedSections.
  std::vector<std::string_view> (*choices)() = nullptr;  ///< The only values there are.
  std::span<const std::string_view> words{};             ///< The same, for keys of a family.
  const Section* section = nullptr;                      ///< Keys of the sections.
  const SectionTypes* types = nullptr;                   ///< Types of kTypedSections.
  bool required = false;
  std::uint16_t needs = 0;          ///< Set of Need.
  std::string_view twin{};          ///< The key to use where `needs` is not met.
  std::string_view default_text{};  ///< As it would be written; empty: see `about`.
  std::string_view about{};         ///< For people.

  [[nodiscard]] bool hasChoices() const noexcept { return choices != nullptr || !words.empty(); }
  [[nodiscard]] std::vector<std::string_view> allChoices() const {
    return choices != nullptr ? choices() : std::vector<std::string_view>{words.begin(), words.end()};
  }
};

/// The keys of one map.
struct Section {
  std::string_view name;  ///< Name of its definition in the schema.
  std::span<const Key> fixed_keys;
  std::string_view about;
  std::span<const Key> (*made_keys)() = nullptr;  ///< In place of fixed_keys, where families add theirs.

  [[nodiscard]] std::span<const Key> keys() const { return made_keys != nullptr ? made_keys() : fixed_keys; }
};

/// nullptr: no such key.
[[nodiscard]] const Key* findKey(const Section& section, std::string_view name);

// The tables. A profile has a motor's keys without those that belong to one motor alone.
extern const Section kRobotSection;
extern const Section kEstopGpioSection;
extern const Section kEnablingGpioSection;
extern const Section kModeGpioSection;
extern const Section kHeartbeatGpioSection;
extern const Section kClientSection;
extern const Section kBusSection;
extern const Section kGroupSection;
extern const SectionTypes kModuleSections;
extern const Section kMotorSection;
extern const Section kProfileSection;
extern const Section kVelocityPidSection;
extern const Section kAnglePidSection;
extern const Section kSimulatedSection;
extern const Section kLoadChangeSection;

/// Names of motors, buses and profiles.
extern const TextForm kNameForm;

/// A maximum that depends on the motor's model.
inline constexpr double kByModel = std::numeric_limits<double>::infinity();

}  // namespace rc10
