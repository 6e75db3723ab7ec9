// Arbitrary bytes to the binary frames: content is never empty, and never longer than it may be.
#include "protocol_stream.hpp"
#include "support/heard_cobs.hpp"

namespace {

using namespace rc10;

void check(const test::HeardCobs& protocol) {
  for (const auto& content : protocol.frames())
    fuzz::require(!content.empty() && content.size() <= CobsProtocol::kLongestContent);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, CobsProtocol::kLongestFrame, test::HeardCobs::make, check);
  fuzz::roundTrip({data, size}, test::HeardCobs::make);
  return 0;
}
