#pragma once

#include <string>
#include <string_view>

namespace rc10::web {

// Answers of a BoundedChild to a page, as JSON.

/// Problems of a configuration with their places, and the robot that it describes: see
/// web/src/protocol.ts, CheckedConfig.
[[nodiscard]] std::string checkedConfigJson(std::string_view text);

/// Input of the next two: the token in the first line, and the text behind it. A token with a line's end is
/// none.
[[nodiscard]] std::string withToken(std::string_view token, std::string_view text);

/// mayReplace(), "true" or "false".
[[nodiscard]] std::string mayReplaceJson(std::string_view token_and_text);

/// ShownConfig.
[[nodiscard]] std::string shownConfigJson(std::string_view token_and_text);

}  // namespace rc10::web
