#pragma once

#include <string>

namespace rc10 {

/// Words for an errno, with the remedy where no file descriptors are left.
[[nodiscard]] std::string errnoText(int error);

}  // namespace rc10
