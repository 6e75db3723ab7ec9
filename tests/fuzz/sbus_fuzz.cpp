// Arbitrary bytes to SBUS: deflections stay within -1 and 1.
#include <cmath>

#include "module/sbus_protocol.hpp"
#include "protocol_stream.hpp"

namespace {

using namespace rc10;

std::unique_ptr<SbusProtocol> make() { return std::make_unique<SbusProtocol>(); }

void check(const SbusProtocol& protocol) {
  for (std::size_t i = 0; i < SbusInput::kChannels; ++i) {
    fuzz::require(std::abs(protocol.input().value.deflection(i)) <= 1.0F);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, SbusProtocol::kFrameBytes, make, check);
  fuzz::roundTrip({data, size}, make);
  return 0;
}
