// Arbitrary datagrams to the LCM gateway: it stays within them, and what it accepts is within the bounds of
// the link and means what lcm-gen's own decoder reads.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "gateway/convert.hpp"
#include "gateway/udpm_datagram.hpp"
#include "link/link_message.hpp"
#include "rc10/command_t.hpp"
#include "rc10/request_t.hpp"

namespace {

using namespace rc10;
using namespace rc10::gateway;

void require(bool condition) {
  if (!condition) std::abort();
}

/// The input behind the fingerprint of `Message`, which a fuzzer would need long to guess.
template <typename Message>
std::vector<std::byte> addressed(std::span<const std::byte> input) {
  std::vector<std::byte> bytes(sizeof(std::int64_t));
  const auto fingerprint = static_cast<std::uint64_t>(Message::getHash());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::byte>(fingerprint >> (56U - 8U * static_cast<unsigned>(i)));
  }
  bytes.insert(bytes.end(), input.begin(), input.end());
  return bytes;
}

void asCommand(std::span<const std::byte> input) {
  const auto bytes = addressed<command_t>(input);
  link::Command command;
  if (decode(bytes, command) != Defect::kNone) return;
  require(link::countsFit(command));
  link::Command copy;
  require(link::open(link::seal(command), copy));
  command_t reference{};
  require(reference.decode(bytes.data(), 0, static_cast<int>(bytes.size())) ==
          static_cast<int>(bytes.size()));
  require(reference.setpoints.size() == command.setpoint_count);
  require(reference.client == command.client.view());
  for (std::size_t i = 0; i < command.setpoint_count; ++i) {
    require(reference.setpoints[i].motor == command.setpoints[i].motor.view());
  }
}

void asRequest(std::span<const std::byte> input) {
  const auto bytes = addressed<request_t>(input);
  link::Request request;
  const auto decoding = decode(bytes, request);
  if (decoding.defect != Defect::kNone) return;
  require(link::countsFit(request));
  if (decoding.forgiven != Defect::kNone) {
    require(request.operation.view() == toString(Operation::kEstop));
    require(request.target.view().empty() && request.value_count == 0);
    return;
  }
  request_t reference{};
  require(reference.decode(bytes.data(), 0, static_cast<int>(bytes.size())) ==
          static_cast<int>(bytes.size()));
  require(reference.target == request.target.view());
  require(reference.operation == request.operation.view());
}

void asDatagram(std::span<const std::byte> input) {
  const auto datagram = parseDatagram(input);
  if (datagram.kind == UdpmDatagram::Kind::kForeign) return;
  require(datagram.channel.size() <= kMaxChannelLength);
  require(datagram.channel.find('\0') == std::string_view::npos);
  require(datagram.channel.size() + 1 + datagram.message.size() <= input.size());
  link::Command command;
  (void)decode(datagram.message, command);
}

/// The link's own messages, from a stranger on the socket.
template <typename Message>
void asLinkMessage(std::span<const std::byte> input) {
  Message message;
  if (!link::open(input, message)) return;
  require(link::countsFit(message));
  require(link::wireSize(message) == input.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span{data, size});
  asCommand(input);
  asRequest(input);
  asDatagram(input);
  asLinkMessage<link::Hello>(input);
  asLinkMessage<link::Welcome>(input);
  asLinkMessage<link::Command>(input);
  asLinkMessage<link::Request>(input);
  asLinkMessage<link::State>(input);
  asLinkMessage<link::Diagnostics>(input);
  return 0;
}
