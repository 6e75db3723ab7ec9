#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "app/result.hpp"

namespace rc10::blackbox {

/// pread() and pwrite() of everything or an error in words (without the name of the file).
[[nodiscard]] Result<void> readAll(int fd, std::uint64_t offset, std::span<std::byte> out);
[[nodiscard]] Result<void> writeAll(int fd, std::uint64_t offset, std::span<const std::byte> bytes);

}  // namespace rc10::blackbox
