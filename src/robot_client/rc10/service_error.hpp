#pragma once

#include <string>

namespace rc10 {
inline namespace robot_client {

struct ServiceError {
  enum class Kind {
    kNotSent,   ///< Something is wrong here: no LCM, an impossible name, called in a handler.
    kNoAnswer,  ///< The message says what to check.
    kRefused,   ///< Not tried: busy, too late, or other definitions of the types.
    kFailed,    ///< Tried, and the server says why it failed.
  };
  Kind kind = Kind::kNotSent;
  std::string message;
};

}  // namespace robot_client
}  // namespace rc10
