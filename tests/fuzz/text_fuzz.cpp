// Arbitrary bytes to the line protocol: numbers are finite, names are names.
#include <cmath>

#include "module/text_protocol.hpp"
#include "protocol_stream.hpp"

namespace {

using namespace rc10;

std::unique_ptr<TextProtocol> make() { return std::make_unique<TextProtocol>(); }

void check(const TextProtocol& protocol) {
  const auto& message = protocol.message().value;
  fuzz::require(message.value_count <= TextMessage::kMostValues);
  fuzz::require((protocol.message().samples > 0) == !message.name().empty());
  for (const double value : message.values) fuzz::require(std::isfinite(value));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, TextProtocol::kLongestLine, make, check);
  fuzz::roundTrip({data, size}, make);
  return 0;
}
