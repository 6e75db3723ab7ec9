// Arbitrary bytes to HiPNUC: values stay finite.
#include <cmath>

#include "module/hipnuc_protocol.hpp"
#include "protocol_stream.hpp"

namespace {

using namespace rc10;

std::unique_ptr<HipnucProtocol> make() { return std::make_unique<HipnucProtocol>(); }

void check(const HipnucProtocol& protocol) {
  const auto& angles = protocol.angles().value;
  const auto& rates = protocol.rates().value;
  for (const float value :
       {angles.roll_deg, angles.pitch_deg, angles.yaw_deg, rates.x_deg_s, rates.y_deg_s, rates.z_deg_s}) {
    fuzz::require(std::isfinite(value));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, HipnucProtocol::kHeaderBytes + HipnucProtocol::kLongestPayload, make, check);
  fuzz::roundTrip({data, size}, make);
  return 0;
}
