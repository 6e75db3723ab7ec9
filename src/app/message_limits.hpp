#pragma once

#include <cstddef>

#include "app/time.hpp"

/// Limits of a message, shared by its sender (the client library, which links nothing of the daemon) and by
/// the daemon, which refuses larger ones.
namespace rc10 {

/// Inputs of a module in one message.
inline constexpr std::size_t kMaxMessageSignals = 32;
/// Bytes of a name: of a client, a module's input, a motor.
inline constexpr std::size_t kMaxNameBytes = 31;
inline constexpr Duration kMaxValidity = std::chrono::milliseconds{1000};
/// Validity of a message that says 0.
inline constexpr Duration kDefaultValidity = std::chrono::milliseconds{50};
/// A request that waited longer is refused: nobody expects an `enable` any more that was sent long ago. One
/// that stops motors is carried out however long it waited.
inline constexpr Duration kMaxRequestAge = std::chrono::seconds{1};
/// Validity of an end: too short for a stream, it lets lapse what its sender said before, and begins nothing.
inline constexpr std::chrono::milliseconds kEndValidity{1};

}  // namespace rc10
