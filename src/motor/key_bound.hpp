#pragma once

#include <cstdint>
#include <string_view>

namespace rc10 {

/// Bound of a model for one key, closer than that of all motors: for editors, which read it in the schema.
struct KeyBound {
  enum class Kind : std::uint8_t {
    kMost,  ///< Up to `most`.
    kOnly,  ///< `only`, and nothing else.
    kNone,  ///< The model has no such key.
  };
  std::string_view key;
  Kind kind = Kind::kMost;
  double most = 0.0;
  std::string_view only{};
};

}  // namespace rc10
