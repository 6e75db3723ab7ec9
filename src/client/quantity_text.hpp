#pragma once

#include <cstdint>
#include <string>

/// Measured values as short text; "-" for a value that is not reported (NaN).
namespace rc10::client {

/// "12.3"
[[nodiscard]] std::string number(double value, int decimals);
/// "12.3 rpm"; without a unit just the number.
[[nodiscard]] std::string quantity(double value, int decimals, const char* unit);
/// "0.4 ms", "83 ms", "12 s"; "-" for a negative age: never.
[[nodiscard]] std::string age(std::int32_t age_us);
/// "61 %"
[[nodiscard]] std::string percent(double ratio);

}  // namespace rc10::client
