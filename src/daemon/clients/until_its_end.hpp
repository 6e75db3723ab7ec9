#pragma once

#include <string_view>

#include "app/result.hpp"
#include "daemon/clients/permissions.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Value of a request with which its effect ends with the client's connection, and its words.
struct UntilItsEnd {
  std::string_view value;
  std::string_view lasting;  ///< The effect without it: "an enable that lasts".
  std::string_view instead;  ///< Duty of a client whose end nobody sees.
};

/// Whether a request has the value; the error is a sentence for its sender. Link thread only.
[[nodiscard]] Result<bool> isAskedFor(const UntilItsEnd& wish, const link::Request& request,
                                      const Speaker& speaker);

}  // namespace rc10
