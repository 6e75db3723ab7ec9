#include "module/gpio_module.hpp"

#include <array>

#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace rc10::test::gpio_module_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

OwnValues input(const std::string& name, int line, bool active_low, int debounce_ms) {
  OwnValues row;
  row.set("name", name);
  row.set("line", static_cast<double>(line));
  row.set("active_low", active_low ? 1.0 : 0.0);
  row.set("bias", std::string{"pull_up"});
  row.set("debounce_ms", static_cast<double>(debounce_ms));
  return row;
}

OwnValues output(const std::string& name, int line, bool active_low, int safe, const std::string& on_estop) {
  OwnValues row;
  row.set("name", name);
  row.set("line", static_cast<double>(line));
  row.set("active_low", active_low ? 1.0 : 0.0);
  row.set("safe_value", static_cast<double>(safe));
  row.set("on_estop", on_estop);
  return row;
}

ModuleSettings settingsOf(std::vector<OwnValues> inputs, std::vector<OwnValues> outputs) {
  ModuleSettings settings;
  settings.name = "io";
  settings.own.set("chip", std::string{"gpiochip0"});
  settings.own.set("inputs", std::move(inputs));
  settings.own.set("outputs", std::move(outputs));
  return settings;
}

/// Inputs `limit` (active low, 5 ms) and `beam` (at once); outputs `valve` (active low), `lock` (safe: 1) and
/// `gripper` (keeps what it holds).
class GpioModuleTest : public ::testing::Test {
 protected:
  enum Place : std::size_t { kLimit, kBeam, kValve, kLock, kGripper, kConnected };
  static constexpr int kLetGoTicks = 1001;

  GpioModuleTest() {
    const auto settings =
        settingsOf({input("limit", 5, true, 5), input("beam", 6, false, 0)},
                   {output("valve", 7, true, 0, "safe"), output("lock", 8, false, 1, "safe"),
                    output("gripper", 9, false, 0, "keep")});
    module = std::move(gpioModuleType().build(settings, outlineOf(1)).value());
    need = std::move(*module->takeGpioNeed());
    image = need.image.get();
    image->open = true;
    image->inputs = 0b01;  // nothing is touched: the pull-up shows
    run(kLetGoTicks);      // a program that begins some time after the start
  }

  void run(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      if (answers) ++image->readings;
      robot.update(*module);
      events.insert(events.end(), robot.events().begin(), robot.events().end());
    }
  }
  void command(double valve, double lock, double gripper) {
    module->setInputs(std::array{valve, lock, gripper});
    run();
  }
  double signal(Place place) { return module->outputs()[place]; }

  FakeRobot robot{1};
  std::unique_ptr<Module_Base> module;
  GpioNeed need;
  GpioImage* image = nullptr;
  bool answers = true;  ///< The chip is read before every tick.
  std::vector<std::size_t> events;
};

TEST_F(GpioModuleTest, TheSignalsAreNamedAsTheLines) {
  EXPECT_THAT(module->signals().inputs, ElementsAre("valve", "lock", "gripper"));
  EXPECT_THAT(module->signals().outputs,
              ElementsAre("limit", "beam", "valve", "lock", "gripper", "connected"));
}

TEST_F(GpioModuleTest, TheDaemonLearnsChipLinesPullsAndSafeLevels) {
  EXPECT_EQ(need.chip, "gpiochip0");
  ASSERT_EQ(need.inputs.size(), 2U);
  EXPECT_EQ(need.inputs[0].line, 5);
  EXPECT_EQ(need.inputs[0].bias, GpioBias::kPullUp);
  ASSERT_EQ(need.outputs.size(), 3U);
  EXPECT_EQ(need.outputs[2].line, 9);
  EXPECT_EQ(need.safe_levels, 0b011U) << "the valve is off while its line is high, the lock is on";
  EXPECT_EQ(image->outputs, need.safe_levels) << "before the first tick";
}

TEST_F(GpioModuleTest, ALowLineIsOneWhereItIsActiveLow) {
  run();
  EXPECT_EQ(signal(kLimit), 0.0);
  EXPECT_EQ(signal(kBeam), 0.0);
  image->inputs = 0b10;
  run(10);
  EXPECT_EQ(signal(kLimit), 1.0);
  EXPECT_EQ(signal(kBeam), 1.0);
}

TEST_F(GpioModuleTest, BouncesOfAContactAreNotSeen) {
  run();
  for (int i = 0; i < 40; ++i) {
    image->inputs ^= 0b01U;
    run();
    EXPECT_EQ(signal(kLimit), 0.0);
  }
  image->inputs = 0b00;
  run(5);
  EXPECT_EQ(signal(kLimit), 0.0);
  run(2);
  EXPECT_EQ(signal(kLimit), 1.0);
}

TEST_F(GpioModuleTest, WithoutTheChipEverySignalMeansNothing) {
  image->inputs = 0b10;
  run(10);
  image->open = false;
  run();
  for (const auto place : {kLimit, kBeam, kValve, kLock, kGripper}) EXPECT_TRUE(std::isnan(signal(place)));
  EXPECT_EQ(signal(kConnected), 0.0);
  image->open = true;
  image->inputs = 0b01;
  run();
  EXPECT_EQ(signal(kLimit), 0.0) << "what was before the loss is forgotten";
  EXPECT_EQ(signal(kConnected), 1.0);
}

TEST_F(GpioModuleTest, AnInputThatIsNotReadKeepsItsValueForATenthOfASecondAndMeansNothingThen) {
  answers = false;
  image->inputs = 0b10;  // of no reading
  run(90);
  EXPECT_EQ(signal(kLimit), 0.0);
  EXPECT_EQ(signal(kBeam), 0.0);
  run(20);
  EXPECT_TRUE(std::isnan(signal(kLimit)));
  EXPECT_TRUE(std::isnan(signal(kBeam)));
  EXPECT_EQ(signal(kConnected), 1.0);
  answers = true;
  run();
  EXPECT_EQ(signal(kLimit), 1.0) << "the first reading counts at once";
}

TEST_F(GpioModuleTest, AnOutputThatDidNotTakeItsLevelIsNotSaidToHaveIt) {
  command(1.0, 0.0, 1.0);
  image->unwritten = 0b001;
  run();
  EXPECT_TRUE(std::isnan(signal(kValve)));
  EXPECT_EQ(signal(kLock), 0.0);
  EXPECT_EQ(image->outputs, 0b100U) << "it is wanted all the same";
  image->unwritten = 0;
  run();
  EXPECT_EQ(signal(kValve), 1.0);
}

TEST_F(GpioModuleTest, OutputsFollowTheirInputs) {
  command(1.0, 0.0, 1.0);
  EXPECT_EQ(image->outputs, 0b100U);
  EXPECT_EQ(signal(kValve), 1.0);
  EXPECT_EQ(signal(kLock), 0.0);
  command(0.0, 1.0, 0.0);
  EXPECT_EQ(image->outputs, need.safe_levels);
}

TEST_F(GpioModuleTest, AnOutputThatIsNotGivenIsAtItsSafeValue) {
  command(1.0, 0.0, 1.0);
  command(kNoSignal, kNoSignal, 1.0);
  EXPECT_EQ(image->outputs, 0b111U);
  module->clearInputs();
  run();
  EXPECT_EQ(image->outputs, need.safe_levels) << "nobody commands any more";
  EXPECT_EQ(signal(kLock), 1.0);
}

TEST_F(GpioModuleTest, AtAnEstopOutputsGoToTheirSafeValuesUnlessTheyKeep) {
  command(1.0, 0.0, 1.0);
  robot.setState(RobotStatus::kEstop);
  run();
  EXPECT_EQ(image->outputs, 0b111U);
  EXPECT_EQ(signal(kGripper), 1.0);
  command(1.0, 0.0, 0.0);
  EXPECT_EQ(image->outputs, 0b011U) << "one that keeps obeys";
}

TEST_F(GpioModuleTest, AfterAnEstopAnOutputWaitsUntilItWasCommandedSafeOnce) {
  command(1.0, 0.0, 1.0);
  robot.setState(RobotStatus::kEstop);
  run(100);
  EXPECT_THAT(events, IsEmpty());
  robot.setState(RobotStatus::kRun);
  run(100);
  EXPECT_EQ(image->outputs, 0b111U);
  EXPECT_THAT(events, ElementsAre(0U)) << "why, told once";
  command(0.0, 0.0, 1.0);
  command(1.0, 0.0, 1.0);
  EXPECT_EQ(image->outputs, 0b110U) << "the valve obeys again; the lock was not commanded safe yet";
  for (int i = 0; i < 10; ++i) {
    module->clearInputs();
    run(20);
    command(1.0, 0.0, 1.0);
    EXPECT_EQ(image->outputs, 0b110U) << "gaps of a program that sends too rarely";
  }
  EXPECT_THAT(events, ElementsAre(0U));
  module->clearInputs();
  run(1000);
  command(1.0, 0.0, 1.0);
  EXPECT_EQ(image->outputs, 0b100U);
}

class GpioModuleStart : public GpioModuleTest {
 protected:
  GpioModuleStart() {
    const auto settings =
        settingsOf({}, {output("valve", 7, false, 0, "safe"), output("gripper", 9, false, 0, "keep")});
    module = std::move(gpioModuleType().build(settings, outlineOf(1)).value());
    need = std::move(*module->takeGpioNeed());
    image = need.image.get();
    image->open = true;
  }
  void ask(double valve) {
    module->setInputs(std::array{valve, valve});
    run();
  }
};

TEST_F(GpioModuleStart, AProgramThatCommandsOnThroughARestartOpensNothing) {
  run(5);
  for (int i = 0; i < 2 * kLetGoTicks; ++i) ask(1.0);
  EXPECT_EQ(image->outputs, 0U);
  EXPECT_THAT(events, ElementsAre(0U)) << "why, told once";
  ask(0.0);
  ask(1.0);
  EXPECT_EQ(image->outputs, 0b11U) << "also the one that keeps what it holds";
}

TEST_F(GpioModuleStart, AProgramThatBeginsASecondAfterTheStartIsObeyedAtOnce) {
  run(kLetGoTicks);
  ask(1.0);
  EXPECT_EQ(image->outputs, 0b11U);
  EXPECT_THAT(events, IsEmpty());
}

TEST_F(GpioModuleStart, OneThatCommandsItSafeFirstIsObeyedAtOnce) {
  ask(0.0);
  ask(1.0);
  EXPECT_EQ(image->outputs, 0b11U);
}

TEST_F(GpioModuleTest, AfterALossOfTheLinesAnOutputWaitsUntilItWasCommandedSafeOnce) {
  command(1.0, 0.0, 1.0);
  image->open = false;
  run();
  image->open = true;
  run(10);
  EXPECT_EQ(image->outputs, need.safe_levels);
  EXPECT_THAT(events, ElementsAre(0U)) << "why, told once";
  command(0.0, 1.0, 0.0);
  command(1.0, 0.0, 1.0);
  EXPECT_EQ(image->outputs, 0b100U);
}

TEST_F(GpioModuleTest, OnesThatWereSafeBeforeTheClearObeyAtOnce) {
  robot.setState(RobotStatus::kEstop);
  run(10);
  robot.setState(RobotStatus::kRun);
  run();
  command(1.0, 0.0, 1.0);
  EXPECT_EQ(image->outputs, 0b100U);
  EXPECT_THAT(events, IsEmpty());
}

TEST(GpioModuleType, NamesAreUniqueAndThereIsALine) {
  const auto error = [](const ModuleSettings& settings) {
    return gpioModuleType().build(settings, outlineOf(1)).error().message;
  };
  EXPECT_EQ(error(settingsOf({input("a", 1, false, 0)}, {output("a", 2, false, 0, "safe")})),
            "outputs[0].name: there is a signal 'a' already; give each line another name");
  EXPECT_EQ(error(settingsOf({input("connected", 1, false, 0)}, {})),
            "inputs[0].name: there is a signal 'connected' already; give each line another name");
  EXPECT_EQ(error(settingsOf({}, {})), "inputs: there is no line; name at least one in inputs or outputs");
}

}  // namespace
}  // namespace rc10::test::gpio_module_test
