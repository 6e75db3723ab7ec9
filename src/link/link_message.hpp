#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "link/link_protocol.hpp"

namespace rc10::link {

/// The bytes of a message that travel: the struct up to its last used array element. A count above
/// the room counts as the room.
[[nodiscard]] std::size_t wireSize(const Hello&) noexcept;
[[nodiscard]] std::size_t wireSize(const Welcome& message) noexcept;
[[nodiscard]] std::size_t wireSize(const Command& message) noexcept;
[[nodiscard]] std::size_t wireSize(const Request& message) noexcept;
[[nodiscard]] std::size_t wireSize(const Response& message) noexcept;
[[nodiscard]] std::size_t wireSize(const State& message) noexcept;
[[nodiscard]] std::size_t wireSize(const Diagnostics& message) noexcept;
[[nodiscard]] std::size_t wireSize(const Event& message) noexcept;
[[nodiscard]] std::size_t wireSize(const ModuleState& message) noexcept;
[[nodiscard]] std::size_t wireSize(const ModuleInfo& message) noexcept;
[[nodiscard]] std::size_t wireSize(const Signals& message) noexcept;
[[nodiscard]] std::size_t wireSize(const TraceChoice&) noexcept;
[[nodiscard]] std::size_t wireSize(const Trace& message) noexcept;
[[nodiscard]] std::size_t wireSize(const Sighting& message) noexcept;

/// The largest message there is: room for a receive buffer.
inline constexpr std::size_t kMaxMessageSize =
    std::max({sizeof(Hello), sizeof(Welcome), sizeof(Command), sizeof(State), sizeof(Diagnostics),
              sizeof(Event), sizeof(Request), sizeof(Response), sizeof(Signals), sizeof(ModuleInfo),
              sizeof(ModuleState), sizeof(TraceChoice), sizeof(Trace), sizeof(Sighting)});

/// Fills in the header; call it last. Returns the bytes to send.
template <typename Message>
[[nodiscard]] std::span<const std::byte> seal(Message& message) noexcept {
  const std::size_t size = wireSize(message);
  message.header = Header{Message::kType, static_cast<std::uint32_t>(size)};
  return {reinterpret_cast<const std::byte*>(&message), size};
}

/// The type of a received datagram, if its header agrees with its length.
[[nodiscard]] bool readHeader(std::span<const std::byte> datagram, Header& header) noexcept;

/// Whether the counts in a message fit its arrays.
[[nodiscard]] bool countsFit(const Hello&) noexcept;
[[nodiscard]] bool countsFit(const Welcome& message) noexcept;
[[nodiscard]] bool countsFit(const Command& message) noexcept;
[[nodiscard]] bool countsFit(const Request& message) noexcept;
[[nodiscard]] bool countsFit(const Response& message) noexcept;
[[nodiscard]] bool countsFit(const State& message) noexcept;
[[nodiscard]] bool countsFit(const Diagnostics& message) noexcept;
[[nodiscard]] bool countsFit(const Event& message) noexcept;
[[nodiscard]] bool countsFit(const ModuleState& message) noexcept;
[[nodiscard]] bool countsFit(const ModuleInfo& message) noexcept;
[[nodiscard]] bool countsFit(const Signals& message) noexcept;
[[nodiscard]] bool countsFit(const TraceChoice& message) noexcept;
[[nodiscard]] bool countsFit(const Trace& message) noexcept;
[[nodiscard]] bool countsFit(const Sighting& message) noexcept;

/// Copies a received datagram of a stranger into `message`. False if the type, the length or a count
/// does not fit; then `message` is unspecified. Text needs no check: Text::view() is always bounded.
template <typename Message>
[[nodiscard]] bool open(std::span<const std::byte> datagram, Message& message) noexcept {
  Header header;
  if (!readHeader(datagram, header) || header.type != Message::kType || datagram.size() > sizeof(Message)) {
    return false;
  }
  std::memcpy(&message, datagram.data(), datagram.size());
  return datagram.size() >= sizeof(Header) && countsFit(message) && wireSize(message) == datagram.size();
}

/// Reads of a defective request for an e-stop what is left: an e-stop counts whatever else its message says.
/// False: it is none; then `request` is unspecified.
[[nodiscard]] bool openEstop(std::span<const std::byte> datagram, Request& request) noexcept;

}  // namespace rc10::link
