// An LED strip from the state of the robot to the bytes on the wire, on an SPI device without a kernel.
#include "daemon/devices/spi_keeper.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "config/module_types.hpp"
#include "daemon/fake_spi.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::spi_keeper_test {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

RobotConfig robotWithStrip() {
  ModuleConfig module;
  module.type = findModuleType("led_strip");
  module.settings.name = "strip";
  module.settings.own.set("device", std::string{"/dev/spidev0.0"});
  module.settings.own.set("pixels", 2.0);
  module.settings.own.set("colour_order", std::string{"grb"});
  module.settings.own.set("brightness_limit", 1.0);
  auto config = twoWheelsAndYaw();
  config.modules.push_back(module);
  return config;
}

class SpiKeeperTest : public ::testing::Test {
 protected:
  /// The scheduler, and a hundred times a second the io thread's part.
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      robot.tick();
      if (robot.scheduler().ticks() % 10 == 0) keeper.turn(robot.now());
    }
  }
  /// Whether green, red and blue of the first pixel are lit in what was sent last.
  std::vector<bool> lit() {
    const auto& bytes = spi.sent.back();
    return {bytes.at(120) >= 0xE0, bytes.at(124) >= 0xE0, bytes.at(128) >= 0xE0};
  }
  double connected() { return robot.snapshot().modules[0].outputs[2]; }
  std::vector<std::string> told() {
    std::vector<std::string> texts;
    robot.exchange().notes.consume_all(
        [&](const link::Event& note) { texts.emplace_back(note.text.view()); });
    return texts;
  }
  const std::vector<std::uint8_t>& dark() { return robot.robot().spiChannels()[0]->settings.rest; }

  FakeSpi spi;
  VirtualRobot robot{robotWithStrip()};
  SpiKeeper keeper{robot.robot().spiChannels(), robot.exchange(), spi.opener()};
};

TEST_F(SpiKeeperTest, PicturesGoOutThirtyTimesASecondInWhole) {
  run(1000);
  EXPECT_EQ(spi.opened, 1);
  EXPECT_EQ(spi.speed_hz, 3'200'000U);
  EXPECT_GE(spi.sent.size(), 28U);
  EXPECT_LE(spi.sent.size(), 31U);
  for (const auto& bytes : spi.sent) EXPECT_EQ(bytes.size(), 240U + 2U * 12U);
  EXPECT_EQ(connected(), 1.0);
  EXPECT_THAT(told(), ElementsAre("/dev/spidev0.0 works, at 3200000 Hz"));
}

TEST_F(SpiKeeperTest, TheStripShowsWhatTheRobotIs) {
  run(50);
  (void)robot.order(Operation::kEnable);
  run(100);
  EXPECT_THAT(lit(), ElementsAre(true, false, false)) << "enabled: green";
  (void)robot.order(Operation::kEstop);
  bool red = false;
  for (int i = 0; i < 20; ++i) {
    run(40);
    EXPECT_FALSE(lit()[0]);
    red |= lit()[1];
  }
  EXPECT_TRUE(red);
}

TEST_F(SpiKeeperTest, AMissingDeviceIsToldOnceTriedWithBackOffAndTakenWhenItComes) {
  spi.missing = "No such file or directory";
  run(3000);
  EXPECT_EQ(connected(), 0.0);
  EXPECT_THAT(told(), ElementsAre("SPI device '/dev/spidev0.0': No such file or directory"));
  spi.missing.clear();
  run(1100);
  EXPECT_EQ(connected(), 1.0);
  EXPECT_THAT(spi.sent, Not(IsEmpty()));
}

TEST_F(SpiKeeperTest, ATransferThatFailsClosesTheDeviceWhichIsTriedAgainButNotChased) {
  run(100);
  (void)told();
  spi.error = EIO;
  run(10'000);
  EXPECT_EQ(connected(), 0.0);
  EXPECT_LE(spi.opened, 20);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("cannot send: Input/output error")));
  spi.error = 0;
  run(1100);
  EXPECT_EQ(connected(), 1.0);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("works")));
}

TEST_F(SpiKeeperTest, ABufferThatIsTooSmallIsNamedWithTheRemedy) {
  spi.error = EMSGSIZE;
  run(5000);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("spidev.bufsiz=4096")));
}

TEST_F(SpiKeeperTest, OfPicturesThatCameTooFastTheNewestIsSentOnce) {
  for (int i = 0; i < 200; ++i) robot.tick();
  keeper.turn(robot.now());
  keeper.turn(robot.now());
  EXPECT_EQ(spi.sent.size(), 1U);
}

TEST_F(SpiKeeperTest, AtTheEndTheStripIsDark) {
  run(100);
  keeper.end();
  EXPECT_EQ(spi.sent.back(), dark());
}

TEST_F(SpiKeeperTest, AStripWhoseSchedulerStandsStillGoesDarkAndComesBack) {
  run(100);
  auto now = robot.now();
  for (int i = 0; i < 2 * SpiKeeper::kSilentTurns; ++i) keeper.turn(now += 10ms);
  EXPECT_EQ(spi.sent.back(), dark());
  const auto sent = spi.sent.size();
  for (int i = 0; i < SpiKeeper::kSilentTurns; ++i) keeper.turn(now += 10ms);
  EXPECT_EQ(spi.sent.size(), sent) << "once is enough";
  run(50);
  EXPECT_NE(spi.sent.back(), dark());
}

TEST_F(SpiKeeperTest, TheTickAllocatesNothingForPictures) {
  run(50);
  const AllocGuard guard;
  for (int i = 0; i < 500; ++i) robot.scheduler().tick(robot.now() + std::chrono::milliseconds{i + 1});
  EXPECT_EQ(guard.allocations(), 0U);
}

}  // namespace
}  // namespace rc10::test::spi_keeper_test
