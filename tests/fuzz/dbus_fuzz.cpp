// Arbitrary bytes to DBUS: what it takes for a remote is within its ranges.
#include <cmath>

#include "module/dbus_protocol.hpp"
#include "protocol_stream.hpp"

namespace {

using namespace rc10;

std::unique_ptr<DbusProtocol> make() { return std::make_unique<DbusProtocol>(); }

void check(const DbusProtocol& protocol) {
  const auto& input = protocol.input().value;
  for (const int stick : {input.right_horizontal, input.right_vertical, input.left_horizontal,
                          input.left_vertical, input.wheel}) {
    fuzz::require(std::abs(stick) <= Dr16Input::kFullDeflection);
  }
  for (const auto position : {input.right_switch, input.left_switch}) {
    fuzz::require(position >= Dr16Input::Switch::kUp && position <= Dr16Input::Switch::kMiddle);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, DbusProtocol::kFrameBytes, make, check);
  fuzz::roundTrip({data, size}, make);
  return 0;
}
