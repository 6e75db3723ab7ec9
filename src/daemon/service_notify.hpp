#pragma once

#include <string_view>

namespace rc10 {

/// Whether systemd started this process, as a service that tells when it is ready.
[[nodiscard]] bool runByService() noexcept;

/// Tells systemd about the service: "READY=1", "WATCHDOG=1", "STOPPING=1" (sd_notify(3)). Does nothing
/// when not run by systemd, and never blocks. Not for real-time threads.
///
/// The protocol is one datagram to $NOTIFY_SOCKET. libsystemd would send it too, but brings compression
/// and cryptography libraries with it: 3.4 MB more locked memory.
void notifyService(std::string_view state) noexcept;

}  // namespace rc10
