#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "app/result.hpp"

namespace rc10 {

/// A number as a configuration writes it: the grammar of JSON, so that nothing depends on the reader
/// (YAML 1.1 takes 010 for eight, 1_000 for a thousand). The error is "reason; fix".
[[nodiscard]] Result<double> parseNumber(std::string_view text);

/// A whole number, without point and exponent.
[[nodiscard]] Result<std::int64_t> parseInteger(std::string_view text);

/// The shortest text that reads back as this number, never with an exponent: "1000000", "0.018".
[[nodiscard]] std::string numberText(double value);
[[nodiscard]] std::string numberText(float value);

}  // namespace rc10
