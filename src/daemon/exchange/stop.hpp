#pragma once

#include "app/vocabulary.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Reason of a stop, and who asked for it: a client or module, or the motor for which a group stopped.
struct Stop {
  StopCause cause = StopCause::kNone;
  link::Name by{};
};

}  // namespace rc10
