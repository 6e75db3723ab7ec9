#pragma once

#include <string>

#include "doctor/finding.hpp"
#include "doctor/latency_histogram.hpp"

namespace rc10::doctor {

/// One finding for people: a line, and the fix on another. `colour`: with a terminal's colours.
[[nodiscard]] std::string text(const Finding& finding, bool colour);
/// "12 passed, 2 warnings, 1 failed"
[[nodiscard]] std::string summary(const Findings& findings);

/// One finding as one line of JSON, without its end.
[[nodiscard]] std::string json(const Finding& finding);
/// The histogram as one line of JSON.
[[nodiscard]] std::string json(const LatencyHistogram& histogram);

}  // namespace rc10::doctor
