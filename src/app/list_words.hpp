#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rc10 {

/// "a, b and c"
[[nodiscard]] std::string listWords(const std::vector<std::string>& words,
                                    std::string_view last_joint = " and ");

}  // namespace rc10
