// The black box of a process: what a restart finds, and what becomes of copies.

#include "daemon/recording/black_box.hpp"

#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "blackbox/image.hpp"
#include "blackbox/memory_box.hpp"
#include "daemon/clients/publication.hpp"
#include "daemon/temp_dir.hpp"

namespace rc10::test::black_box_test {
namespace {

using ::testing::HasSubstr;

class BlackBoxTest : public ::testing::Test {
 protected:
  BlackBoxTest() {
    robot.robot = "hero";
    RobotDescription::Motor motor;
    motor.name = "left";
    motor.model = "M3508";
    robot.motors.push_back(motor);
    RobotDescription::Bus bus;
    bus.name = "chassis";
    bus.interface = "can0";
    robot.buses.push_back(bus);
  }

  std::unique_ptr<BlackBox> open() {
    return std::move(BlackBox::create({run.path(), state_dir, 1}, robot, log).value());
  }
  static void estop(BlackBox& box) {
    Event event;
    event.code = EventCode::kRobotState;
    event.severity = Severity::kError;
    event.value = static_cast<std::int32_t>(RobotStatus::kEstop);
    box.recorder().event(event);
    box.drain();
  }
  /// One life of the thread that makes copies, which ends with what is still to be made.
  static void makeCopies(BlackBox& box) {
    std::stop_source stop;
    stop.request_stop();
    box.runCopies(stop.get_token());
  }
  std::vector<std::string> copies(const std::string& cause) {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(state.path())) {
      const auto name = entry.path().string();
      if (name.find("-" + cause + ".blackbox") != std::string::npos) found.push_back(name);
    }
    return found;
  }
  static blackbox::Recording read(const std::string& path) {
    return blackbox::Recording::parse(blackbox::readImage(path).value()).value();
  }

  TempDir run;
  TempDir state;
  std::string state_dir = state.path();
  RobotDescription robot;
  std::ostringstream output;
  std::shared_ptr<spdlog::logger> log =
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(output));
};

TEST_F(BlackBoxTest, TheFileSaysWhoseItIs) {
  const auto box = open();
  const auto recording = read(run / "hero.blackbox");
  EXPECT_EQ(recording.header().robot.view(), "hero");
  EXPECT_EQ(recording.header().pid, ::getpid());
  EXPECT_EQ(recording.motorName(0), "left");
  EXPECT_EQ(recording.interfaceName(0), "can0");
  EXPECT_GT(recording.control().wall_offset_ns, 0);
  EXPECT_EQ(recording.control().ended, 0U);
}

TEST_F(BlackBoxTest, AnEstopIsCopied) {
  const auto box = open();
  estop(*box);
  makeCopies(*box);
  ASSERT_EQ(copies("estop").size(), 1U);
  const auto recording = read(copies("estop")[0]);
  EXPECT_EQ(all<blackbox::Event>(recording).size(), 1U);
  EXPECT_EQ(recording.header().cause.view(), "estop");
  EXPECT_THAT(output.str(), HasSubstr(copies("estop")[0]));
}

TEST_F(BlackBoxTest, WithoutACauseNothingIsCopied) {
  const auto box = open();
  makeCopies(*box);
  EXPECT_TRUE(std::filesystem::is_empty(state.path()));
}

TEST_F(BlackBoxTest, TheFileOfARunThatDidNotStopIsCopiedAtTheNextStart) {
  {
    const auto killed = open();
    estop(*killed);
  }
  const auto next = open();
  makeCopies(*next);
  ASSERT_EQ(copies("crash").size(), 1U);
  EXPECT_EQ(all<blackbox::Event>(read(copies("crash")[0])).size(), 1U);
  EXPECT_THAT(output.str(), HasSubstr("ended without stopping"));
  EXPECT_FALSE(std::filesystem::exists(run / "hero.blackbox.crashed"));
  EXPECT_EQ(read(run / "hero.blackbox").size(), 0U);
}

TEST_F(BlackBoxTest, TheFileOfARunThatStoppedIsNot) {
  {
    const auto stopped = open();
    estop(*stopped);
    stopped->end();
  }
  EXPECT_EQ(read(run / "hero.blackbox").control().ended, 1U);
  const auto next = open();
  makeCopies(*next);
  EXPECT_TRUE(copies("crash").empty());
}

TEST_F(BlackBoxTest, AFileThatIsNoneIsReplaced) {
  { std::ofstream(run / "hero.blackbox") << "something else"; }
  const auto box = open();
  makeCopies(*box);
  EXPECT_TRUE(std::filesystem::is_empty(state.path()));
  EXPECT_EQ(read(run / "hero.blackbox").header().robot.view(), "hero");
}

TEST_F(BlackBoxTest, WhereCopiesCannotBeKeptThereIsOneWarningAndTheFileStays) {
  {
    const auto killed = open();
    estop(*killed);
  }
  state_dir = state / "none";
  const auto box = open();
  for (int i = 0; i < 3; ++i) {
    estop(*box);
    makeCopies(*box);
  }
  const auto text = output.str();
  EXPECT_THAT(text, HasSubstr(state_dir + ": No such file or directory"));
  EXPECT_THAT(text, HasSubstr("RC10_STATE_DIR"));
  EXPECT_EQ(text.find("No such file"), text.rfind("No such file")) << text;
  EXPECT_TRUE(std::filesystem::exists(run / "hero.blackbox.crashed"));
}

TEST_F(BlackBoxTest, ARunFolderWithoutRoomIsAnErrorWithAReason) {
  const auto box = BlackBox::create({"/nowhere", state_dir, 1}, robot, log);
  ASSERT_FALSE(box);
  EXPECT_THAT(box.error().message, HasSubstr("/nowhere/hero.blackbox"));
}

}  // namespace
}  // namespace rc10::test::black_box_test
