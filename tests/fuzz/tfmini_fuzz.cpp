// Arbitrary bytes to a TFmini: what it calls valid is a distance.
#include <cmath>

#include "module/tfmini_protocol.hpp"
#include "protocol_stream.hpp"

namespace {

using namespace rc10;

std::unique_ptr<TfminiProtocol> make() { return std::make_unique<TfminiProtocol>(); }

void check(const TfminiProtocol& protocol) {
  const auto& range = protocol.range().value;
  fuzz::require(!range.valid || (range.distance_m >= 0.0F && range.distance_m < 656.0F));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, TfminiProtocol::kFrameBytes, make, check);
  fuzz::roundTrip({data, size}, make);
  return 0;
}
