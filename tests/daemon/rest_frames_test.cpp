#include "daemon/rest_frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "bus/frame_text.hpp"
#include "daemon/temp_dir.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::rest_frames_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class RestFrames : public ::testing::Test {
 protected:
  /// Simulated, because a kernel without CAN has no other bus, and then told to be on an interface.
  static std::unique_ptr<Robot> robotOn(const std::string& interface) {
    auto robot = Robot::build(twoWheelsAndYaw()).value();
    robot->buses()[0].interface = interface;
    return robot;
  }
  std::string written() const {
    std::ifstream file(dir / "hero/rest-frames");
    return {std::istreambuf_iterator<char>{file}, {}};
  }

  TempDir dir;
};

TEST_F(RestFrames, HoldEveryCommandIdOfEveryDriveWithoutTorque) {
  const auto frames = parseFrameList(restFramesText(*robotOn("can0"), "hero")).value();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].frame.id, (CanId{0x200, false}));
  EXPECT_EQ(frames[1].frame.id, (CanId{0x2FE, false}));
  for (const auto& [interface, frame] : frames) {
    EXPECT_EQ(interface, "can0");
    EXPECT_EQ(frame.length, 8);
    EXPECT_EQ(frame.data, decltype(frame.data){});
  }
}

TEST_F(RestFrames, ARobotOfSimulatedDrivesHasNone) {
  const auto robot = Robot::build(twoWheelsAndYaw()).value();
  ASSERT_TRUE(writeRestFrames(*robot, dir.path(), "hero"));
  EXPECT_THAT(written(), StartsWith("#"));
  EXPECT_TRUE(parseFrameList(written())->empty());
}

TEST_F(RestFrames, TakeThePlaceOfThoseOfAnEarlierRun) {
  std::filesystem::create_directory(dir / "hero");
  std::ofstream(dir / "hero/rest-frames") << std::string(10'000, 'x');
  std::ofstream(dir / "hero/rest-frames.new") << std::string(10'000, 'x');  // of one that was killed
  ASSERT_TRUE(writeRestFrames(*robotOn("can0"), dir.path(), "hero"));
  EXPECT_EQ(parseFrameList(written())->size(), 2U);
  EXPECT_FALSE(std::filesystem::exists(dir / "hero/rest-frames.new"));
}

TEST_F(RestFrames, AFolderThatCannotBeMadeIsNamed) {
  const auto written_to = writeRestFrames(*robotOn("can0"), dir / "no/such", "hero");
  ASSERT_FALSE(written_to);
  EXPECT_THAT(written_to.error().message, HasSubstr(dir / "no/such/hero"));
}

}  // namespace
}  // namespace rc10::test::rest_frames_test
