#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "blackbox/format.hpp"

namespace rc10::blackbox {

/// Where a piece of an image goes. An error ends the copy.
using Sink = std::function<Result<void>(std::uint64_t offset, std::span<const std::byte> bytes)>;

/// Whether a file can begin like this: magic, version and sizes that fit each other.
[[nodiscard]] Result<void> checkHeader(const Header& header);

/// Reads a black box, also one that is being written, so that what arrives at `sink` is whole; the beginning
/// comes last. `amend` may change the header on its way. Not for real-time threads.
[[nodiscard]] Result<void> takeImage(int fd, const Sink& sink,
                                     const std::function<void(Header&)>& amend = {});

/// The whole file as one consistent image. The error names the file.
[[nodiscard]] Result<std::vector<std::byte>> readImage(const std::string& path);

}  // namespace rc10::blackbox
