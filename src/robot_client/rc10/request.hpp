#pragma once

#include <map>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace rc10 {
inline namespace robot_client {

/// Reason why one motor of a request was not done.
struct MotorReason {
  std::string motor;
  std::string reason;
};

/// rc10d's answer to a request that it has carried out.
struct Response {
  std::string message;                   ///< In words: "enable: 6 of 7 motors (...)".
  std::vector<MotorReason> not_done;     ///< Motors that may fail (`optional` in the configuration).
  std::map<std::string, double> values;  ///< Named with their units.
};

struct RequestError {
  enum class Kind {
    kNotSent,   ///< Something is wrong here: no LCM, an impossible name, called in a handler.
    kNoAnswer,  ///< The message says what to check.
    kRefused,   ///< rc10d did not try: unknown operation or target, or not allowed now.
    kFailed,    ///< Tried; `motors` says which could not and why, the others may have succeeded.
  };
  Kind kind = Kind::kNotSent;
  std::string message;  ///< In words, with the remedy.
  std::vector<MotorReason> motors;
};

using RequestResult = tl::expected<Response, RequestError>;

}  // namespace robot_client
}  // namespace rc10
