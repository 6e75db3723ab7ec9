#pragma once

#include <cstdint>

namespace rc10 {
inline namespace robot_client {

/// A random number for this run of a client, above 0: zero is what a program that forgets about sessions
/// sends.
[[nodiscard]] std::int64_t newSessionNumber();

}  // namespace robot_client
}  // namespace rc10
