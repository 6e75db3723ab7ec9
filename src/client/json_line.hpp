#pragma once

#include <string>
#include <type_traits>

#include <nlohmann/json.hpp>

namespace rc10::client {

/// Keys in the order in which they were added.
using Json = nlohmann::ordered_json;

/// One line, without its end. Bytes that are no UTF-8 are replaced: names may be anything.
[[nodiscard]] std::string lineOf(const Json& json);

/// A float with as many digits as it has, not those of the double nearest to it.
[[nodiscard]] double shortest(float value);
/// As it is.
template <typename Number>
  requires(!std::is_same_v<Number, float>)
[[nodiscard]] Number shortest(Number value) {
  return value;
}

/// "current,stall" as a list.
[[nodiscard]] Json listOf(const std::string& words);

}  // namespace rc10::client
