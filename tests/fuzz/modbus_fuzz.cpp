// Arbitrary bytes to a Modbus master that waits for an answer.
#include <cmath>

#include "module/modbus_rtu.hpp"
#include "protocol_stream.hpp"

namespace {

using namespace rc10;

std::unique_ptr<ModbusRtu> make() {
  auto modbus = std::make_unique<ModbusRtu>();
  std::array<std::uint8_t, ModbusRtu::kLongestFrame> out;
  const auto asked = modbus->begin({.address = 1, .first = 0, .count = 2},
                                   MonotonicTime{std::chrono::hours{1}}, std::chrono::milliseconds{50}, out);
  fuzz::require(asked == 8);
  return modbus;
}

void check(const ModbusRtu& modbus) {
  fuzz::require(modbus.values().size() <= ModbusRtu::kMostRead);
  fuzz::require(modbus.counters().frames <= 1);
  fuzz::require((modbus.state() == ModbusState::kDone) == (modbus.modbusCounters().answers == 1));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, ModbusRtu::kLongestFrame, make, check);
  fuzz::roundTrip({data, size}, make);
  return 0;
}
