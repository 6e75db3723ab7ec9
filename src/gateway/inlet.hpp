#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "app/event_code.hpp"
#include "app/time.hpp"
#include "client/link_client.hpp"
#include "gateway/convert.hpp"
#include "gateway/outlet.hpp"
#include "gateway/throttle.hpp"
#include "gateway/udpm_datagram.hpp"

namespace rc10::gateway {

/// From LCM to rc10d: decodes what comes on <robot>.v1.command, .request and those of the modules and passes
/// on what is whole, each with the time at which this host received it.
class Inlet {
 public:
  Inlet(LinkClient& rc10d, Outlet& outlet);

  /// The channels to subscribe to.
  [[nodiscard]] std::vector<std::string> channels() const;

  /// A datagram that this host received at `received`. False: rc10d has ended.
  bool handle(const UdpmDatagram& datagram, MonotonicTime received, MonotonicTime now,
              link::Origin origin = link::Origin::kElsewhere);

  struct Counters {
    std::uint64_t commands = 0;  ///< Passed on.
    std::uint64_t requests = 0;
    std::uint64_t signals = 0;
    std::uint64_t defective = 0;
    std::uint64_t stale_requests = 0;
    std::uint64_t busy = 0;  ///< Dropped, since rc10d did not read.
  };
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

 private:
  bool command(const UdpmDatagram& datagram, MonotonicTime received, MonotonicTime now);
  bool request(const UdpmDatagram& datagram, MonotonicTime received, MonotonicTime now);
  bool signals(std::size_t module, const UdpmDatagram& datagram, MonotonicTime received, MonotonicTime now);
  bool sent(LinkClient::SendStatus status, std::uint64_t& counter, MonotonicTime now);
  void refuse(const std::string& reason);
  void reportDefect(Defect defect, std::string_view channel, MonotonicTime now,
                    const char* verdict = "is refused:");
  void report(EventCode code, Severity severity, std::string text, MonotonicTime now);

  LinkClient& rc10d_;
  Outlet& outlet_;
  std::string command_channel_;
  std::string request_channel_;
  std::vector<std::string> module_channels_;
  link::Command command_;
  link::Signals signals_;
  link::Request request_;
  std::array<Throttle, 3> throttles_;  // one per event of the gateway
  Counters counters_;
};

}  // namespace rc10::gateway
