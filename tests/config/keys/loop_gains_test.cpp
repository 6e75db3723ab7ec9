#include "config/keys/loop_gains.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/config_text.hpp"

namespace rc10::test::loop_gains_test {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

MotorLoops loopsOf(const std::string& keys) {
  const auto motor = motorOf("{name: wheel, id: 1, " + keys + "}");
  return {motor.settings.model, motor.traits(), motor.settings.loops};
}

std::string whyNot(std::string_view name, double value, const MotorLoops& loops) {
  const auto change = gainChange(name, value, loops);
  return change ? "accepted" : change.error().message;
}

/// The configuration's message for the same key and number, without its place.
std::string whyNotInTheFile(const std::string& key, const std::string& number) {
  const auto errors =
      errorsOf(robotWith("{name: wheel, model: M3508, id: 1, velocity_pid: {" + key + ": " + number + "}}"));
  return errors.empty() ? "accepted" : errors.front();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

const std::string kPosition = "model: M3508, velocity_pid: {type: position}";
const std::string kIncremental = "model: M3508, velocity_pid: {type: incremental}";
const std::string kVolts = "model: GM6020, command: voltage";
const std::string kVesc = "model: VESC, pole_pairs: 7, angle: tachometer";

TEST(LoopGains, EveryNumberOfTheTwoSectionsIsAGain) {
  std::set<std::string> paths;
  for (const auto& gain : allGainKeys()) paths.insert(gain.path());
  std::set<std::string> keys;
  for (const auto* section : {&kVelocityPidSection, &kAnglePidSection}) {
    for (const Key& key : section->keys()) {
      if (key.kind == ValueKind::kNumber)
        keys.insert(std::string{section->name} + "." + std::string{key.name});
    }
  }
  EXPECT_EQ(paths, keys);
}

TEST(LoopGains, AMotorHasThoseThatMeanSomethingForIt) {
  const auto paths = [](const std::string& keys) {
    std::set<std::string> out;
    for (const auto& gain : gainKeysOf(loopsOf(keys))) out.insert(gain.path());
    return out;
  };
  EXPECT_EQ(paths(kPosition).size(), 15U);
  EXPECT_TRUE(paths(kPosition).contains("velocity_pid.integral_limit_a"));
  EXPECT_TRUE(paths(kIncremental).contains("velocity_pid.target_bandwidth_rad_s"));
  EXPECT_FALSE(paths(kIncremental).contains("velocity_pid.integral_limit_a"));
  EXPECT_TRUE(paths(kVolts).contains("velocity_pid.kp_v_per_rpm"));
  EXPECT_FALSE(paths(kVolts).contains("velocity_pid.kp_a_per_rpm"));
  EXPECT_EQ(paths(kVesc).size(), 8U) << "the angle loop's";
  EXPECT_TRUE(paths("model: DM4310, master_id: 17").empty());
}

TEST(LoopGains, AGainIsNamedByItsPathByItsKeyOrInBrief) {
  const auto loops = loopsOf(kPosition);
  for (const auto* name : {"velocity_pid.kp_a_per_rpm", "kp_a_per_rpm", "velocity.kp", "velocity_pid.kp"}) {
    const auto change = gainChange(name, 0.8, loops);
    ASSERT_TRUE(change) << change.error().message;
    EXPECT_EQ(change->gain, LoopGain::kVelocityKp);
    EXPECT_EQ(change->value, 0.8F);
  }
  EXPECT_EQ(gainChange("angle.velocity_limit", 90, loops)->gain, LoopGain::kAngleVelocityLimit);
  EXPECT_EQ(gainChange("velocity.kp", 1, loopsOf(kVolts))->gain, LoopGain::kVelocityKp);
}

TEST(LoopGains, WhatWasToldIsAccepted) {
  for (const auto& loops : {loopsOf(kPosition), loopsOf(kVesc)}) {
    for (const auto& gain : gainKeysOf(loops)) {
      const double told = static_cast<double>(gainOf(loops.config, gain.gain));
      const auto change = gainChange(gain.path(), told, loops);
      ASSERT_TRUE(change) << change.error().message;
      EXPECT_EQ(change->value, static_cast<float>(told));
    }
  }
}

TEST(LoopGains, ANumberIsCheckedAsInTheFileAndInTheSameWords) {
  const auto loops = loopsOf(kPosition);
  EXPECT_THAT(whyNotInTheFile("kp_a_per_rpm", "-1"), EndsWith(whyNot("velocity.kp", -1, loops)));
  EXPECT_THAT(whyNot("velocity.kp", -1, loops),
              HasSubstr("velocity_pid.kp_a_per_rpm: -1 is below 0 A/rpm; use "));
  EXPECT_THAT(whyNotInTheFile("deadband_rpm", "20000"), EndsWith(whyNot("velocity.deadband", 20000, loops)));
  EXPECT_THAT(whyNot("angle.velocity_limit", -1, loops), HasSubstr("use more than 0"));
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THAT(whyNot("velocity.kp", value, loops), HasSubstr("not a finite number"));
}

TEST(LoopGains, WhatIsNoGainOfThisMotorSaysWhatIs) {
  const auto loops = loopsOf(kPosition);
  EXPECT_THAT(whyNot("velocity_pid.kp_a_per_rmp", 1, loops), EndsWith("did you mean kp_a_per_rpm?"));
  EXPECT_THAT(whyNot("kp_a_per_rmp", 1, loops), EndsWith("did you mean velocity_pid.kp_a_per_rpm?"));
  EXPECT_THAT(whyNot("colour", 1, loops), HasSubstr("known here: velocity_pid.kp_a_per_rpm, "));
  EXPECT_THAT(whyNot("torque.kp", 1, loops),
              HasSubstr("there is no loop 'torque'; use velocity_pid or angle_pid"));
  EXPECT_THAT(whyNot("velocity.kpp", 1, loops), EndsWith("did you mean kp_a_per_rpm?"));
  EXPECT_THAT(whyNot("velocty.kp", 1, loops), EndsWith("angle_pid; did you mean velocity?"));
  EXPECT_THAT(whyNot("derivative_filter_hz", 1, loops),
              HasSubstr("write velocity_pid.derivative_filter_hz or angle_pid.derivative_filter_hz"));
  EXPECT_THAT(whyNot("velocity_pid.kp_v_per_rpm", 1, loops),
              HasSubstr("is commanded in amperes; use kp_a_per_rpm"));
  EXPECT_THAT(whyNot("velocity.target_bandwidth", 1, loops), HasSubstr("belongs to type: incremental"));
  EXPECT_THAT(whyNot("velocity.kp", 1, loopsOf(kVesc)), HasSubstr("only gains of angle_pid"));
}

TEST(LoopGains, WhatIsReadAtTheStartOnlySaysSo) {
  const auto loops = loopsOf(kPosition);
  for (const auto* name : {"current_limit_a", "velocity_pid.type", "velocity_limit_rpm", "gear_ratio"})
    EXPECT_THAT(whyNot(name, 1, loops), HasSubstr("at the start only; change it in the robot's file"))
        << name;
  EXPECT_THAT(whyNot("velocity_limit_rpm", 1, loops), HasSubstr("or write angle_pid.velocity_limit_rpm"));
}

TEST(LoopGains, TheLinesMakeTheSameLoopsInABlockAndBetweenBraces) {
  for (const auto& keys : {kPosition, kIncremental, kVolts, kVesc}) {
    auto loops = loopsOf(keys);
    float value = 0.5F;
    for (const auto& gain : gainKeysOf(loops)) *gainIn(loops.config, gain.gain) = value += 0.125F;
    const auto lines = gainLines(loops);
    const auto model = keys.substr(0, keys.find(", velocity_pid"));
    const std::string indent = "\n        ";
    const std::string block = "name: wheel" + indent + "id: 1" + indent + replaced(model, ", ", indent) +
                              indent + replaced(lines, "\n", indent);
    const auto pasted = parseRobotConfig(robotWith(block), "hero.yaml");
    ASSERT_TRUE(pasted.config) << pasted.errorText() << block;
    const auto& in_block = pasted.config->buses[0].motors[0].settings.loops;
    const auto in_braces = loopsOf(model + ", " + replaced(lines, "\n", ", ")).config;
    for (const auto& gain : gainKeysOf(loops)) {
      EXPECT_EQ(gainOf(in_block, gain.gain), gainOf(loops.config, gain.gain)) << gain.path();
      EXPECT_EQ(gainOf(in_braces, gain.gain), gainOf(loops.config, gain.gain)) << gain.path();
    }
    EXPECT_EQ(in_block.velocity.index(), loops.config.velocity.index());
  }
}

TEST(LoopGains, WhatAModelLeavesUnlimitedIsNotWritten) {
  EXPECT_EQ(gainLines(loopsOf(kVesc)).find("velocity_limit_rpm"), std::string::npos);
  EXPECT_EQ(gainLines(loopsOf("model: DM4310, master_id: 17")), "");
}

}  // namespace
}  // namespace rc10::test::loop_gains_test
