#pragma once

#include <sys/resource.h>

#include <cstdint>
#include <string>

#include "app/result.hpp"

namespace rc10::sandbox {

struct Bounds {
  rlim_t memory_bytes;
  rlim_t files;
};

/// No real time, no locked memory, bounded memory and descriptors, not dumpable, and under memory pressure
/// the first to die. A limit that is lower already stays.
[[nodiscard]] Result<void> bound(const Bounds& bounds);

/// `kept`: a bit for each capability (CAP_…) that stays where the process has it.
[[nodiscard]] Result<void> dropCapabilities(std::uint64_t kept = 0);

/// The error of a step that failed.
[[nodiscard]] tl::unexpected<Error> notDropped(const std::string& what, int error);

}  // namespace rc10::sandbox
