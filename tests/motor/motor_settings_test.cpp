#include "motor/motor_settings.hpp"

#include <gtest/gtest.h>

namespace rc10::test::motor_settings {
namespace {

TEST(MotorSettings, AnEffortLimitOfItsOwnStandsBeforeTheModels) {
  MotorSettings settings;
  EXPECT_EQ(effortLimitOf(settings, 20.0F), 20.0F);
  settings.effort_limit = 6.5F;
  EXPECT_EQ(effortLimitOf(settings, 20.0F), 6.5F);
}

TEST(MotorSettings, AGearOfItsOwnStandsBeforeTheModels) {
  struct Model {
    double gear_ratio = 19.0;
  };
  MotorSettings settings;
  EXPECT_EQ(gearRatioOf(settings, Model{}), 19.0);
  settings.gear_ratio = 6.0;
  EXPECT_EQ(gearRatioOf(settings, Model{}), 6.0);
}

}  // namespace
}  // namespace rc10::test::motor_settings
