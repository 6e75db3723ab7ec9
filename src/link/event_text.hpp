#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rc10::link {

/// An event in words, from its numbers: `code` as in event_t.lcm, `value` and `extra` as
/// daemon/exchange/events.hpp says for it. The daemon and the readers of its recordings use the same words.
[[nodiscard]] std::string eventText(std::int32_t code, std::int32_t value, std::int32_t extra,
                                    std::string_view client);

}  // namespace rc10::link
