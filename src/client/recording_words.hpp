#pragma once

#include <array>

namespace rc10::client {

/// By blackbox::Verdict.
inline constexpr std::array kVerdictWords{"applied", "expired", "not owner"};

}  // namespace rc10::client
