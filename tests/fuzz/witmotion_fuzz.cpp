// Arbitrary bytes to WitMotion: angles stay within a turn.
#include <cmath>

#include "module/witmotion_protocol.hpp"
#include "protocol_stream.hpp"

namespace {

using namespace rc10;

std::unique_ptr<WitMotionProtocol> make() { return std::make_unique<WitMotionProtocol>(); }

void check(const WitMotionProtocol& protocol) {
  const auto& angles = protocol.angles().value;
  for (const float angle : {angles.roll_deg, angles.pitch_deg, angles.yaw_deg}) {
    fuzz::require(std::abs(angle) <= 180.0F);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, WitMotionProtocol::kFrameBytes, make, check);
  fuzz::roundTrip({data, size}, make);
  return 0;
}
