// The tick of robots with modules, of every type, without one allocation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "blackbox/memory_box.hpp"
#include "config/load_config.hpp"
#include "config/module_types.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/alloc_guard.hpp"
#include "support/module_cases.hpp"

namespace rc10::test::module_allocation_test {
namespace {

using namespace std::chrono_literals;

class ModuleAllocationTest : public ::testing::TestWithParam<ModuleCase> {
 protected:
  // As of a serial device that is read in the RX thread.
  void hear() {
    if (GetParam().frame.empty()) return;
    chunk_.received = robot_.now();
    ASSERT_TRUE((*robot_.robot().serialChannels())[0].chunks.push(chunk_));
  }
  void tick(int index) {
    if (message_.client.view() == "test") {
      message_.received = robot_.now();
      message_.deadline = robot_.now() + 50ms;
      ASSERT_TRUE(robot_.exchange().signals.push(message_));
    }
    if (index % 14 == 0) hear();
    if (auto* lines = robot_.robot().lineBanks()) (*lines)[0].show(0, 0);
    robot_.tick();
    Event event;
    while (robot_.exchange().events.pop(event)) {
    }
  }
  [[nodiscard]] const Module_Base& module() { return *robot_.robot().modules()[0].module; }

  void SetUp() override {
    message_.values.fill(kNoSignal);
    for (const auto& [name, value] : GetParam().inputs) {
      const auto& inputs = module().signals().inputs;
      const auto input = std::find(inputs.begin(), inputs.end(), name);
      ASSERT_NE(input, inputs.end()) << name;
      message_.values[static_cast<std::size_t>(input - inputs.begin())] = value;
      message_.client = "test";
    }
    std::copy(GetParam().frame.begin(), GetParam().frame.end(), chunk_.data.begin());
    chunk_.size = static_cast<std::uint16_t>(GetParam().frame.size());
    robot_.run(10);
    (void)robot_.order(Operation::kEnable);
  }

  MemoryBox box_;
  FlightRecorder recorder_{box_.handOff()};
  VirtualRobot robot_{parseRobotConfig(GetParam().yaml(), "robot.yaml").config.value(), &recorder_};
  SignalMessage message_;
  SerialChunk chunk_;
};

TEST_P(ModuleAllocationTest, AThousandTicksAllocateNothing) {
  for (int i = 0; i < 100; ++i) tick(i);
  const AllocGuard guard;
  for (int i = 0; i < 1000; ++i) tick(i);
  EXPECT_EQ(guard.allocations(), 0U);
  // It was at work: it drove its motors, or heard its device.
  for (int motor = 0; motor < GetParam().motors; ++motor) {
    EXPECT_EQ(robot_.motor(static_cast<std::size_t>(motor)).owner.view(), "part") << "m" << motor;
  }
  const auto& outputs = module().outputs();
  EXPECT_TRUE(std::any_of(outputs.begin(), outputs.end(), [](double x) {
    return std::isfinite(x) && x != 0.0;
  })) << "it says nothing";
}

INSTANTIATE_TEST_SUITE_P(EveryType, ModuleAllocationTest, ::testing::ValuesIn(moduleCases()),
                         [](const auto& robot) { return robot.param.type; });

TEST(ModuleCases, ThereIsOneForEveryType) {
  const auto cases = moduleCases();
  for (const auto* type : moduleTypes()) {
    EXPECT_TRUE(std::any_of(cases.begin(), cases.end(), [&](const auto& c) {
      return c.type == type->name();
    })) << type->name();
  }
}

}  // namespace
}  // namespace rc10::test::module_allocation_test
