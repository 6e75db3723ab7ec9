#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "support/dji_frames.hpp"

namespace rc10::test::dji_check_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string refusal(const DjiModel& model, const std::function<void(MotorSettings&)>& change) {
  MotorSettings config = djiConfig(model);
  config.name = "arm";
  change(config);
  const auto result = DJI_Motor::check(config);
  return result ? std::string{} : result.error().message;
}

TEST(DjiCheck, TheDefaultsOfEveryModelPass) {
  for (const DjiModel* model : djiModels()) {
    for (const auto command : {DjiCommand::kCurrent, DjiCommand::kVoltage}) {
      if (!model->command(command).exists()) continue;
      for (int id = 1; id <= model->max_id; ++id)
        EXPECT_TRUE(DJI_Motor::check(djiConfig(*model, id, command)));
    }
  }
}

TEST(DjiCheck, NamesTheMotorTheKeyAndTheRange) {
  EXPECT_EQ(refusal(kM3508, [](auto& c) { c.id = 9; }), "motor 'arm': id 9 is outside 1-8 of M3508");
  EXPECT_EQ(refusal(kGM6020, [](auto& c) { c.id = 8; }), "motor 'arm': id 8 is outside 1-7 of GM6020");
  EXPECT_EQ(refusal(kM3508, [](auto& c) { c.effort_limit = 20.5F; }),
            "motor 'arm': current_limit_a 20.5 is outside 0-20 A of M3508");
  EXPECT_EQ(refusal(kM2006, [](auto& c) { c.direction = 0; }), "motor 'arm': direction 0 must be 1 or -1");
  EXPECT_EQ(refusal(kM2006, [](auto& c) { c.gear_ratio = -3.0; }),
            "motor 'arm': gear_ratio -3 must be above 0, or 0 for the model's own 36");
}

TEST(DjiCheck, RefusesACommandTheModelLacks) {
  const auto message = refusal(kM3508, [](auto& c) { c.own = djiOwn(DjiCommand::kVoltage); });
  EXPECT_EQ(message, "motor 'arm': command: M3508 obeys current only");
}

TEST(DjiCheck, RefusesAnAbsoluteZeroWithoutAnAbsoluteEncoder) {
  EXPECT_NE(refusal(kM3508, [](auto& c) { c.zero_deg = 5.0; }).find("zero_deg needs"), std::string::npos);
  EXPECT_NE(refusal(kGM6020, [](auto& c) { c.zero_deg = 5.0, c.gear_ratio = 2.0; }).find("zero_deg needs"),
            std::string::npos);
  EXPECT_NE(refusal(kGM6020, [](auto& c) { c.zero_deg = 5.0, c.zero_at_power_on = true; }).find("exclude"),
            std::string::npos);
  EXPECT_EQ(refusal(kGM6020, [](auto& c) { c.zero_deg = 123.4; }), "");
}

TEST(DjiCheck, RefusesNumbersThatAreNotFiniteOrNegativeGains) {
  EXPECT_NE(refusal(kM3508, [](auto& c) { c.effort_limit = kNan; }), "");
  EXPECT_NE(refusal(kM3508, [](auto& c) { c.gear_ratio = static_cast<double>(kNan); }), "");
  EXPECT_NE(refusal(kGM6020, [](auto& c) { c.zero_deg = static_cast<double>(kNan); }), "");
  EXPECT_NE(refusal(kM3508, [](auto& c) { c.loops.angle.kp = -1.0F; }).find("angle_pid"), std::string::npos);
  EXPECT_NE(refusal(kM3508, [](auto& c) { c.loops.velocity_limit_rpm = kNan; }).find("velocity_limit_rpm"),
            std::string::npos);
  EXPECT_NE(refusal(kM3508, [](auto& c) { c.loops.velocity = PID_Incremental::Config{.ki = kNan}; })
                .find("velocity_pid"),
            std::string::npos);
  EXPECT_EQ(
      refusal(kM3508,
              [](auto& c) { c.loops.angle.integral_separation = std::numeric_limits<float>::infinity(); }),
      "");
}

TEST(DjiCheck, RefusesAMotorWithoutNameOrModel) {
  EXPECT_NE(refusal(kM3508, [](auto& c) { c.name.clear(); }).find("name is missing"), std::string::npos);
  EXPECT_NE(refusal(kM3508, [](auto& c) { c.model.clear(); }).find("model is missing"), std::string::npos);
}

TEST(DjiModels, AreFoundByTheirNames) {
  EXPECT_EQ(findDjiModel("M3508"), &kM3508);
  EXPECT_EQ(findDjiModel("M2006"), &kM2006);
  EXPECT_EQ(findDjiModel("GM6020"), &kGM6020);
  EXPECT_EQ(findDjiModel("m3508"), nullptr);
  EXPECT_EQ(findDjiModel(""), nullptr);
}

TEST(DjiModels, TheUsersClassNamesDifferOnlyInTheirTable) {
  MotorSettings config = djiConfig(kM3508);
  EXPECT_EQ(M3508{config}.modelName(), "M3508");
  EXPECT_EQ(M2006{config}.modelName(), "M2006");
  EXPECT_EQ(GM6020{config}.modelName(), "GM6020");
}

}  // namespace
}  // namespace rc10::test::dji_check_test
