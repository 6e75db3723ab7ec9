#pragma once

#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "bus/serial_format.hpp"

namespace rc10 {

/// Where udev keeps a name for every serial adapter that stays the same whatever is plugged in first.
inline constexpr const char* kSerialNames = "/dev/serial/by-id";

/// Opens a serial port: raw, non-blocking, for us alone (TIOCEXCL and flock), without flow control, with what
/// had come before thrown away. Where the driver has a low-latency mode, it is on. read() gives EAGAIN while
/// there is nothing, and 0 or EIO once the port is gone. Bytes with a parity or framing error are left out:
/// the protocol misses a byte and resynchronises, rather than believe a wrong one. Main or io thread only: it
/// allocates. The error names the path, the cause and what to do.
[[nodiscard]] Result<UniqueFd> openSerialPort(const std::string& path, const SerialFormat& format);

/// The name under `names` that leads to the same device as `path`; empty if there is none or `path` is it.
[[nodiscard]] std::string steadySerialName(const std::string& path, const std::string& names = kSerialNames);

}  // namespace rc10
