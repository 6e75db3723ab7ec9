// One answer of an asked drive that is lost, at the slowest rhythm that the configuration takes.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "config/motor_families.hpp"
#include "daemon/supervision/one_motor.hpp"

namespace rc10::test::axis_lost_answer_test {
namespace {

struct Asked {
  std::string keys;
  std::string bus;
};

void PrintTo(const Asked& subject, std::ostream* out) { *out << subject.keys; }

bool takes(const Asked& subject, int divider) {
  return OneMotor::parse(subject.keys + ", command_divider: " + std::to_string(divider), subject.bus)
      .config.has_value();
}

int largestDivider(const Asked& subject) {
  int taken = 1;
  for (int refused = 101; refused - taken > 1;) {
    const int middle = (taken + refused) / 2;
    (takes(subject, middle) ? taken : refused) = middle;
  }
  return taken;
}

/// The first model of each family, length of silence and kind of encoder.
std::vector<Asked> askedDrives() {
  const std::string moteus_bus = "data_bitrate: 5000000\n    ";
  std::vector<Asked> found;
  std::set<std::tuple<std::string, Duration, bool>> seen;
  for (const auto& entry : motorFamilies()) {
    for (const auto model : entry.family->models()) {
      const std::string family{entry.family->name()};
      std::string keys = "model: " + std::string{model} + ", id: 1, zero: power_on";
      if (family == "Damiao") keys += ", master_id: 17, watchdog_ms: 1000";
      if (family == "moteus") keys += ", motor_kv_rpm_per_v: 100, watchdog_ms: 1000";
      if (family == "RobStride") keys += ", watchdog_ms: 1000";
      if (family == "LK-Tech") keys += ", velocity_limit_rpm: 300";
      if (family == "CubeMars") keys += ", protocol: mit";
      const Asked subject{keys, family == "moteus" ? moteus_bus : ""};
      const auto outcome = OneMotor::parse(keys, subject.bus);
      if (!outcome.config) continue;
      const auto traits = outcome.config->buses[0].motors[0].traits();
      if (traits.asked && seen.emplace(family, traits.restart_silence, traits.absolute).second)
        found.push_back(subject);
    }
  }
  return found;
}

TEST(LostAnswer, IsTriedWithEachFamilyThatIsAsked) {
  std::set<std::string> families;
  for (const auto& subject : askedDrives()) {
    const auto outcome = OneMotor::parse(subject.keys, subject.bus);
    families.emplace(outcome.config->buses[0].motors[0].family->name());
  }
  EXPECT_EQ(families,
            (std::set<std::string>{"CubeMars", "Damiao", "LK-Tech", "MyActuator", "RobStride", "moteus"}));
}

class LostAnswerTest : public ::testing::TestWithParam<Asked> {};

// The next one is late, too.
TEST_P(LostAnswerTest, IsNoRestart) {
  const int divider = largestDivider(GetParam());
  EXPECT_FALSE(takes(GetParam(), divider + 1));
  SCOPED_TRACE(divider);
  OneMotor motor{GetParam().keys + ", command_divider: " + std::to_string(divider), GetParam().bus};
  auto& robot = motor.robot();
  const double here_deg = motor.seen().feedback.total_angle_deg;
  const auto tick = [&] { motor.follow(ControlMode::kTotalAngle, here_deg, 1); };
  const auto waitForAnswer = [&] {
    const auto samples = motor.seen().feedback.samples;
    for (int i = 0; i < 3 * divider + 3 && motor.seen().feedback.samples == samples; ++i) tick();
    ASSERT_GT(motor.seen().feedback.samples, samples);
  };
  for (int i = 0; i < 2000; ++i) tick();
  for (int trial = 0; trial < 5; ++trial) {
    waitForAnswer();
    ASSERT_TRUE(motor.seen().feedback.zeroed) << trial;
    const auto samples = motor.seen().feedback.samples;
    robot.simBus().silence(0, true);
    for (int i = 0; i < divider; ++i) tick();
    ASSERT_EQ(motor.seen().feedback.samples, samples) << "it is lost";
    robot.simBus().silence(0, false);
    robot.stampLate(std::chrono::microseconds{100});
    for (int i = 0; i < divider; ++i) tick();
    robot.stampLate({});
    ASSERT_GT(motor.seen().feedback.samples, samples) << "the next one";
    for (int i = 0; i < 200; ++i) {
      tick();
      ASSERT_EQ(motor.seen().status, MotorStatus::kActive) << static_cast<int>(motor.seen().fault);
      ASSERT_TRUE(motor.seen().feedback.zeroed) << trial;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, LostAnswerTest, ::testing::ValuesIn(askedDrives()));

}  // namespace
}  // namespace rc10::test::axis_lost_answer_test
