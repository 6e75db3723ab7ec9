#pragma once

#include <string>
#include <string_view>

namespace rc10::web {

// Answers of a BoundedChild to a page, as JSON.

/// Problems of a configuration with their places, and the robot that it describes: see
/// web/src/protocol.ts, CheckedConfig.
[[nodiscard]] std::string checkedConfigJson(std::string_view text);

/// mayReplace(), "true" or "false", of the same input as that of shownConfigJson().
[[nodiscard]] std::string mayReplaceJson(std::string_view token_and_text);

/// ShownConfig. The first line of the input is the token, all others are the text.
[[nodiscard]] std::string shownConfigJson(std::string_view token_and_text);

}  // namespace rc10::web
