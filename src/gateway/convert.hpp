#pragma once

#include <cstddef>
#include <span>

#include "gateway/wire_reader.hpp"
#include "link/link_protocol.hpp"
#include "rc10/diagnostics_t.hpp"
#include "rc10/event_t.hpp"
#include "rc10/response_t.hpp"
#include "rc10/robot_state_t.hpp"
#include "rc10/signals_t.hpp"

/// Between LCM messages and link messages. Incoming messages are from strangers and decoded here, since
/// lcm-gen's decoders believe the counts in a message; outgoing ones are encoded by lcm-gen's code.
namespace rc10::gateway {

/// Larger than the largest valid command_t and request_t.
inline constexpr std::size_t kMaxIncoming = std::size_t{16} * 1024;

/// Decodes a command_t. The numbers pass as they are, NaN too: rc10d judges them. received_ns stays.
/// After a defect `command` is unspecified.
[[nodiscard]] Defect decode(std::span<const std::byte> bytes, link::Command& command) noexcept;

/// Decodes a signals_t; received_ns and module stay. After a defect `signals` is unspecified.
[[nodiscard]] Defect decode(std::span<const std::byte> bytes, link::Signals& signals) noexcept;

/// Decodes a request_t; received_ns stays. After a defect other than kTruncated or kOtherDefinitions,
/// client, session and seq may be valid: see `identified`.
struct RequestDecoding {
  Defect defect = Defect::kNone;
  bool identified = false;          ///< Client, session and seq are those of the sender: it can be answered.
  Defect forgiven = Defect::kNone;  ///< Defect of an e-stop, which counts whatever else its message says.
};
[[nodiscard]] RequestDecoding decode(std::span<const std::byte> bytes, link::Request& request) noexcept;

// Link to LCM. `out` is reused, so that its strings and vectors keep their memory. Counts above the room
// of the link message count as the room.
void convert(const link::Welcome& welcome, const link::State& state, robot_state_t& out);
void convert(const link::Diagnostics& diagnostics, diagnostics_t& out);
void convert(const link::Event& event, event_t& out);
void convert(const link::Response& response, std::int64_t utime, response_t& out);
/// `out.client` becomes the owner: who gives the module's inputs.
void convert(const link::ModuleInfo& info, const link::ModuleState& state, signals_t& out);

/// The encoded message in `buffer`; empty if it does not fit.
template <typename Message>
[[nodiscard]] std::span<const std::byte> encode(const Message& message, std::span<std::byte> buffer) {
  const int size = message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
  return size < 0 ? std::span<const std::byte>{} : buffer.first(static_cast<std::size_t>(size));
}

}  // namespace rc10::gateway
