#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/convert.hpp"
#include "gateway/udpm_datagram.hpp"
#include "link/link_protocol.hpp"

namespace rc10::gateway {

/// Where encoded LCM messages go.
class LcmPublisher {
 public:
  LcmPublisher() = default;
  LcmPublisher(const LcmPublisher&) = delete;
  LcmPublisher& operator=(const LcmPublisher&) = delete;
  virtual ~LcmPublisher() = default;
  virtual void publish(std::string_view channel, std::span<const std::byte> message) noexcept = 0;
};

/// From rc10d to LCM: puts what it sends on <robot>.v1.state, .diagnostics, .event, .response and
/// .<module>.state.
class Outlet {
 public:
  Outlet(const link::Welcome& welcome, LcmPublisher& publisher);

  /// A datagram of rc10d.
  void forward(std::span<const std::byte> datagram);

  void publish(const link::Event& event);
  void publish(const link::Response& response);

  /// Datagrams that were not understood.
  [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }

 private:
  template <typename Message>
  void send(const std::string& channel, const Message& message) {
    const auto bytes = encode(message, buffer_);
    if (!bytes.empty()) publisher_.publish(channel, bytes);
  }

  template <typename Message>
  [[nodiscard]] bool open(std::span<const std::byte> datagram);
  // False: about a module that there is not.
  [[nodiscard]] bool take(const link::State& state);
  [[nodiscard]] bool take(const link::Diagnostics& diagnostics);
  [[nodiscard]] bool take(const link::Event& event);
  [[nodiscard]] bool take(const link::Response& response);
  [[nodiscard]] bool take(const link::ModuleInfo& info);
  [[nodiscard]] bool take(const link::ModuleState& state);

  const link::Welcome& welcome_;
  LcmPublisher& publisher_;
  std::string state_channel_;
  std::string diagnostics_channel_;
  std::string event_channel_;
  std::string response_channel_;
  robot_state_t state_{};
  diagnostics_t diagnostics_{};
  event_t event_{};
  response_t response_{};
  signals_t signals_{};
  struct Module {
    std::string channel;
    link::ModuleInfo info;
  };
  std::vector<Module> modules_;
  std::array<std::byte, kMaxPayload> buffer_{};
  std::uint64_t malformed_ = 0;
};

}  // namespace rc10::gateway
