#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motor/odrive_bench.hpp"

namespace rc10::test::odrive_family_test {
namespace {

using namespace odrive_bench;

TEST_F(OdriveMotor, RefusesWhatNoKeysRangeCanSay) {
  auto settings = odriveSettings();
  EXPECT_TRUE(odriveFamily().check(settings));
  settings.velocity_limit_rpm = 0.0F;
  const auto no_velocity = odriveFamily().check(settings);
  ASSERT_FALSE(no_velocity);
  EXPECT_THAT(no_velocity.error().message, HasSubstr("velocity_limit_rpm"));
  settings = odriveSettings();
  settings.effort_limit = 0.0F;
  const auto no_current = odriveFamily().check(settings);
  ASSERT_FALSE(no_current);
  EXPECT_THAT(no_current.error().message, HasSubstr("current_limit_a"));
}

TEST_F(OdriveMotor, TelemetryThatIsOffIsNotReported) {
  auto settings = odriveSettings();
  EXPECT_TRUE(odriveFamily().traits("ODrive_S1", settings.own).reports_temperature);
  EXPECT_FALSE(odriveFamily().traits("ODrive_v3", settings.own).reports_temperature);
  EXPECT_EQ(odriveFamily().busUse(settings).feedback.size(), 5U);
  settings.own.set("telemetry_hz", 0.0);
  EXPECT_FALSE(odriveFamily().traits("ODrive_S1", settings.own).reports_temperature);
  EXPECT_EQ(odriveFamily().busUse(settings).feedback.size(), 2U);
}

TEST_F(OdriveMotor, ItsBusUseCoversAllThatItSendsAndHears) {
  const auto use = odriveFamily().busUse(odriveSettings());
  ASSERT_FALSE(motor_->filters().empty());
  ASSERT_FALSE(motor_->commandIds().empty());
  for (const auto& filter : motor_->filters()) {
    EXPECT_TRUE(accepts(use.sends.front(), makeClassicFrame(filter.id, {})));
  }
  for (const auto id : motor_->commandIds()) {
    EXPECT_TRUE(accepts(use.obeys.front(), makeClassicFrame(id, {})));
    EXPECT_TRUE(std::any_of(use.commands.begin(), use.commands.end(),
                            [id](const auto& stream) { return stream.id == id; }));
  }
}

}  // namespace
}  // namespace rc10::test::odrive_family_test
