#include "blackbox/file_bytes.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace rc10::blackbox {

Result<void> readAll(int fd, std::uint64_t offset, std::span<std::byte> out) {
  while (!out.empty()) {
    const auto done = ::pread(fd, out.data(), out.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return fail(std::strerror(errno));
    if (done == 0) return fail("it is cut off");
    out = out.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  return {};
}

Result<void> writeAll(int fd, std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto done = ::pwrite(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return fail(std::strerror(errno));
    if (done == 0) return fail("nothing could be written");
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  return {};
}

}  // namespace rc10::blackbox
