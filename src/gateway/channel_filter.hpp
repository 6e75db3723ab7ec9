#pragma once

#include <linux/filter.h>

#include <string>
#include <vector>

namespace rc10::gateway {

/// A socket filter (classic BPF) for a UDP socket that lets only the given LCM channels in. On a busy LCM
/// network the kernel then throws camera images and our own states away before they fill the receive
/// buffer. Of a fragmented message the first part passes, so that its sender can be told.
[[nodiscard]] std::vector<sock_filter> channelFilter(const std::vector<std::string>& channels);

}  // namespace rc10::gateway
