#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rc10 {

/// The candidate a typist most likely meant; empty: none is near.
[[nodiscard]] std::string_view nearest(std::string_view typed,
                                       const std::vector<std::string_view>& candidates);

/// "; did you mean NAME?", or nothing if no candidate is near; "NAME or NAME" if two have more words behind
/// these: `payload` of payload_kg and payload_at_m.
[[nodiscard]] std::string didYouMean(std::string_view typed, const std::vector<std::string_view>& candidates);

}  // namespace rc10
