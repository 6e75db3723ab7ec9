#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/robot_config.hpp"

namespace rc10 {

struct YamlEntry;

/// A value of a YAML document as it was written: duplicate keys, quotes and tags are still there.
struct YamlNode {
  enum class Kind : std::uint8_t { kNull, kScalar, kList, kMap };

  Kind kind = Kind::kNull;
  SourcePlace place;
  std::string tag;                 ///< Given with `!`; empty: none.
  std::string text;                ///< Scalars.
  bool in_quotes = false;          ///< Scalars: quoted or a block, hence text and never a number.
  bool refused = false;            ///< A problem with it has been reported: it counts as not given.
  std::vector<YamlNode> items;     ///< Lists.
  std::vector<YamlEntry> entries;  ///< Maps, in the order of the file.

  /// The value of the first entry with this key; nullptr: none.
  [[nodiscard]] const YamlNode* find(std::string_view key) const noexcept;
};

struct YamlEntry {
  YamlNode key;
  YamlNode value;
};

/// "a list", "a number-like text", ...: for messages.
[[nodiscard]] std::string_view kindWords(const YamlNode& node) noexcept;

}  // namespace rc10
