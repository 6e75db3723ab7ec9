// GPIO lines of modules, from a client's signal to the pin and back, on a chip without a kernel.
#include "daemon/threads/line_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/module_types.hpp"
#include "daemon/fake_gpio.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::line_loop_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

OwnValues lineRow(const std::string& name, int line) {
  OwnValues row;
  row.set("name", name);
  row.set("line", static_cast<double>(line));
  return row;
}

/// A `gpio` module with the input `limit` (line 4, active low, 3 ms) and the outputs `valve` (line 5) and
/// `lock` (line 6, safe: 1).
RobotConfig robotWithLines() {
  auto limit = lineRow("limit", 4);
  limit.set("active_low", 1.0);
  limit.set("bias", std::string{"pull_up"});
  limit.set("debounce_ms", 3.0);
  auto valve = lineRow("valve", 5);
  valve.set("on_estop", std::string{"safe"});
  auto lock = lineRow("lock", 6);
  lock.set("safe_value", 1.0);
  lock.set("on_estop", std::string{"safe"});
  ModuleConfig module;
  module.type = findModuleType("gpio");
  module.settings.name = "io";
  module.settings.own.set("chip", std::string{"chip"});
  module.settings.own.set("inputs", std::vector{limit});
  module.settings.own.set("outputs", std::vector{valve, lock});
  auto config = twoWheelsAndYaw();
  config.modules.push_back(module);
  return config;
}

/// The scheduler and the lines thread's part, in turns, in virtual time.
class LineLoopTest : public ::testing::Test {
 protected:
  enum Signal : std::size_t { kLimit, kValve, kLock, kConnected };

  LineLoopTest() {
    loop.turn(robot.now(), 0);
    run(1001);  // a program that begins a second after the start is obeyed at once
  }

  void run(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      robot.tick();
      loop.turn(robot.now(), robot.scheduler().ticks());
    }
  }
  void command(double valve_wanted, double lock_wanted, Duration validity = 50ms, const char* client = "test",
               int priority = 0) {
    SignalMessage message;
    message.client = client;
    message.session = 7;
    message.priority = priority;
    message.deadline = robot.now() + validity;
    message.values.fill(kNoSignal);
    message.values[0] = valve_wanted;
    message.values[1] = lock_wanted;
    ASSERT_TRUE(robot.exchange().signals.push(message));
    run();
  }
  double signal(Signal place) { return robot.snapshot().modules[0].outputs[place]; }
  std::vector<std::string> told() {
    std::vector<std::string> texts;
    robot.exchange().line_notes.consume_all(
        [&](const link::Event& note) { texts.emplace_back(note.text.view()); });
    return texts;
  }

  FakeGpio::Chip chip{{"chip:4", {.high = true}}, {"chip:5", {.high = true}}, {"chip:6", {}}};
  FakeGpio::Line& limit = chip["chip:4"];
  FakeGpio::Line& valve = chip["chip:5"];
  FakeGpio::Line& lock = chip["chip:6"];
  VirtualRobot robot{robotWithLines()};
  LineLoop loop{*robot.robot().lineBanks(), std::make_unique<FakeGpio>(chip), robot.exchange()};
};

TEST_F(LineLoopTest, LinesAreTakenAtTheStartWithTheOutputsSafe) {
  EXPECT_EQ(limit.user, "limit");
  EXPECT_EQ(limit.bias, GpioBias::kPullUp);
  EXPECT_THAT(valve.levels, ElementsAre(false)) << "from the moment on in which it is an output";
  EXPECT_THAT(lock.levels, ElementsAre(true));
  run();
  EXPECT_EQ(signal(kConnected), 1.0);
  EXPECT_THAT(told(), ElementsAre("chip: 1 inputs and 2 outputs are open"));
}

TEST_F(LineLoopTest, ASwitchIsSeenOnceItHasLastedAndIsActiveLow) {
  run(10);
  EXPECT_EQ(signal(kLimit), 0.0);
  limit.high = false;
  run(2);
  EXPECT_EQ(signal(kLimit), 0.0);
  run(4);
  EXPECT_EQ(signal(kLimit), 1.0);
}

TEST_F(LineLoopTest, ASignalReachesThePinInTheSameTick) {
  run(5);
  command(1.0, 0.0);
  EXPECT_TRUE(valve.high);
  EXPECT_FALSE(lock.high);
  EXPECT_EQ(signal(kValve), 1.0);
}

TEST_F(LineLoopTest, WhenTheLeaseEndsTheOutputsAreSafeAgain) {
  command(1.0, 0.0, 10ms);
  run(8);
  EXPECT_TRUE(valve.high);
  run(3);
  EXPECT_FALSE(valve.high);
  EXPECT_TRUE(lock.high);
}

TEST_F(LineLoopTest, AHigherPriorityTakesTheOutputsOver) {
  command(1.0, 0.0);
  command(0.0, 1.0, 50ms, "remote", 10);
  EXPECT_FALSE(valve.high);
  command(1.0, 0.0);
  EXPECT_FALSE(valve.high) << "the first client has to wait";
}

TEST_F(LineLoopTest, AnEstopMakesTheOutputsSafe) {
  run(5);
  command(1.0, 0.0, 10s);
  (void)robot.order(Operation::kEstop);
  run(2);
  EXPECT_FALSE(valve.high);
  EXPECT_TRUE(lock.high);
  (void)robot.order(Operation::kClear);
  run(20);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
  EXPECT_FALSE(valve.high) << "it is still commanded, but does not come back by itself";
}

TEST_F(LineLoopTest, WhenTheProcessStopsTheOutputsAreSafeAndTheLinesAreLetGo) {
  command(1.0, 0.0, 10s);
  robot.scheduler().beginStop();
  run();
  EXPECT_FALSE(valve.high) << "before the motors have stopped";
  loop.end();
  EXPECT_TRUE(lock.high);
  EXPECT_EQ(valve.user + lock.user + limit.user, "");
}

TEST_F(LineLoopTest, TheEndAloneMakesTheOutputsSafe) {
  command(1.0, 0.0, 10s);
  loop.end();
  EXPECT_FALSE(valve.high);
  EXPECT_TRUE(lock.high);
}

TEST_F(LineLoopTest, ASchedulerThatStandsStillMakesTheOutputsSafe) {
  command(1.0, 0.0, 10s);
  (void)told();
  const auto ticks = robot.scheduler().ticks();
  auto now = robot.now();
  for (int i = 0; i < 190; ++i) loop.turn(now += 1ms, ticks);
  EXPECT_TRUE(valve.high);
  for (int i = 0; i < 20; ++i) loop.turn(now += 1ms, ticks);
  EXPECT_FALSE(valve.high);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("no tick for 0.2 s")));
  run();
  EXPECT_TRUE(valve.high) << "commanded all the time";
}

TEST_F(LineLoopTest, APauseOfTheWholeComputerIsNoSilence) {
  command(1.0, 0.0, 10s);
  loop.turn(robot.now() + 5s, robot.scheduler().ticks());
  EXPECT_TRUE(valve.high);
}

TEST_F(LineLoopTest, AChipThatVanishesIsAStateAndIsOpenedAgainWithSafeOutputs) {
  run(10);
  command(1.0, 0.0, 10s);
  (void)told();
  for (auto& [name, line] : chip) line.refuses = true;
  run(LineLoop::kMaxBadTurns + 1);
  EXPECT_EQ(signal(kConnected), 0.0);
  EXPECT_TRUE(std::isnan(signal(kLimit)));
  run(500);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("an input was not read"), HasSubstr("the chip is gone"),
                                  HasSubstr("there is no chip")))
      << "the loss, and once why it cannot be opened";
  for (auto& [name, line] : chip) {
    line.refuses = false;
    line.levels.clear();
  }
  run(1100);
  EXPECT_EQ(signal(kConnected), 1.0);
  ASSERT_GE(valve.levels.size(), 1U);
  EXPECT_FALSE(valve.levels[0]);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("are open")));
}

TEST_F(LineLoopTest, AFailedTransferIsTriedAgainAndLetsNoLineGo) {
  command(1.0, 0.0, 10s);
  (void)told();
  valve.refuses = true;
  command(0.0, 0.0, 10s);
  run(LineLoop::kMaxBadTurns - 2);
  EXPECT_TRUE(valve.high);
  EXPECT_TRUE(std::isnan(signal(kValve))) << "what it is nobody knows";
  EXPECT_EQ(signal(kConnected), 1.0);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("output valve did not take its level")));
  valve.refuses = false;
  run(2);
  EXPECT_FALSE(valve.high);
  EXPECT_EQ(signal(kValve), 0.0);
  EXPECT_FALSE(lock.high) << "the others never noticed";
  EXPECT_THAT(told(), IsEmpty());
}

TEST_F(LineLoopTest, AnInputThatIsNotReadOnceKeepsItsValue) {
  limit.high = false;
  run(10);
  (void)told();
  for (int i = 0; i < 20; ++i) {
    limit.refuses = true;
    run(LineLoop::kMaxBadTurns - 1);
    EXPECT_EQ(signal(kLimit), 1.0);
    limit.refuses = false;
    run();
  }
  EXPECT_EQ(signal(kConnected), 1.0);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("an input was not read"))) << "once a second";
}

TEST_F(LineLoopTest, AChipThatCanBeOpenedButDoesNotAnswerIsNotOpenAndToldOnce) {
  for (auto& [name, line] : chip) line.refuses = true;
  run(10);
  (void)told();
  for (auto& [name, line] : chip) line.opens_dead = true;
  run(3000);
  EXPECT_EQ(signal(kConnected), 0.0);
  EXPECT_THAT(told(), ElementsAre("chip: the chip does not answer"));
}

TEST_F(LineLoopTest, OneOutputThatRefusesDoesNotKeepTheOthersFromTheirSafeValues) {
  command(1.0, 0.0, 10s);
  valve.refuses = true;
  run(30);
  EXPECT_TRUE(lock.high);
  EXPECT_EQ(signal(kConnected), 0.0);
}

TEST(LineLoopStart, AChipThatIsNotThereIsTriedWithBackOffAndToldOnce) {
  VirtualRobot robot{robotWithLines()};
  FakeGpio::Chip chip{{"chip:4", {}}, {"chip:5", {}}};
  LineLoop loop{*robot.robot().lineBanks(), std::make_unique<FakeGpio>(chip), robot.exchange()};
  for (int i = 0; i < 3000; ++i) {
    robot.tick();
    loop.turn(robot.now(), robot.scheduler().ticks());
  }
  EXPECT_EQ(chip["chip:5"].user, "") << "all lines or none";
  link::Event note;
  ASSERT_TRUE(robot.exchange().line_notes.pop(note));
  EXPECT_THAT(std::string{note.text.view()}, HasSubstr("lock: chip:6"));
  EXPECT_FALSE(robot.exchange().line_notes.pop(note));
  EXPECT_LT(chip["chip:5"].levels.size(), 10U) << "tried once a second in the end";
  chip["chip:6"] = {};
  for (int i = 0; i < 1100; ++i) loop.turn(robot.now() + std::chrono::milliseconds{i}, 1);
  EXPECT_EQ(chip["chip:6"].user, "lock");
}

TEST(LineLoopStart, WithoutAGpioModuleThereIsNothingToDo) {
  VirtualRobot robot{twoWheelsAndYaw()};
  EXPECT_EQ(robot.robot().lineBanks(), nullptr);
}

TEST(KernelGpio, AMissingChipIsAnErrorThatNamesLineAndRemedy) {
  const auto gpio = kernelGpio();
  const auto input = gpio->openInput("limit", {"no_such_chip", 3}, GpioBias::kPullUp);
  ASSERT_FALSE(input);
  EXPECT_THAT(input.error().message, HasSubstr("limit: no_such_chip:3: "));
  EXPECT_THAT(input.error().message, HasSubstr("`gpiodetect`"));
  EXPECT_FALSE(gpio->openOutput("valve", {"no_such_chip", 3}, false));
}

}  // namespace
}  // namespace rc10::test::line_loop_test
