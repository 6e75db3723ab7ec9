#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace rc10 {

/// Failure before the first tick: cause, place and fix, in words.
/// The real-time threads never make one.
struct Error {
  std::string message;
};

template <typename T>
using Result = tl::expected<T, Error>;

/// `return fail("...")` from any function that returns a Result.
[[nodiscard]] inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

}  // namespace rc10
