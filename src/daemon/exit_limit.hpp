#pragma once

#include "app/time.hpp"

namespace rc10 {

/// For the end of main(): the process has `limit` left for what is still to do, such as the last words of a
/// log that nobody reads; then it ends with `status`.
void limitExit(Duration limit, int status);

}  // namespace rc10
