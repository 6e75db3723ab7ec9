#pragma once

#include <string>

#include "config/keys/key_table.hpp"
#include "config/yaml/yaml_node.hpp"

namespace rc10 {

/// Whether the whole text has the form.
[[nodiscard]] bool matches(std::string_view text, const TextForm& form);

/// "reason; fix" if the scalar is not a value of this key; empty if it is.
[[nodiscard]] std::string whyNoValue(const YamlNode& node, const Key& key);

/// "reason; fix" if the text has not the form of the key.
[[nodiscard]] std::string whyNoText(const YamlNode& node, const Key& key);

/// "reason; fix" if the number is outside the key's range; empty if it is not.
[[nodiscard]] std::string whyOutOfRange(double value, const Key& key);

/// Expected value in words: "a number in A", "a list", ...
[[nodiscard]] std::string wantedWords(const Key& key);

/// "use 2 to 1000", "use more than 0": completes a message about a number out of range.
[[nodiscard]] std::string useWords(const Range& range, std::string_view unit);

/// "'Current' is not one of current and voltage; did you mean current?"
[[nodiscard]] std::string notOneOf(std::string_view text, const std::vector<std::string_view>& choices);

}  // namespace rc10
