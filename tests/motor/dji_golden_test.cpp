// Every line of tests/golden/dji.txt, both ways.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drives/dji/dji_group.hpp"
#include "support/dji_frames.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::dji_golden_test {
namespace {

using Values = std::vector<std::pair<std::string, double>>;

Values parseValues(std::istream& line) {
  Values values;
  for (std::string word; line >> word;) {
    const auto equals = word.find('=');
    values.emplace_back(word.substr(0, equals), std::strtod(word.c_str() + equals + 1, nullptr));
  }
  return values;
}

void checkCommand(std::istream& line) {
  std::string model_name;
  std::string unit;
  std::string text;
  line >> model_name >> unit >> text;
  const DjiModel* model = findDjiModel(model_name);
  ASSERT_NE(model, nullptr);
  const auto kind = unit == "A" ? DjiCommand::kCurrent : DjiCommand::kVoltage;
  const CanFrame expected = frameOf(text);
  DJI_Group group(expected.id);
  std::vector<std::unique_ptr<DJI_Motor>> motors;
  const Values efforts = parseValues(line);
  ASSERT_FALSE(efforts.empty());
  for (const auto& [id, effort] : efforts) {
    motors.push_back(std::make_unique<DJI_Motor>(djiConfig(*model, std::stoi(id), kind)));
    ASSERT_TRUE(group.registerMotor(*motors.back()));
    motors.back()->order(FrameKind::kCommand);
    const auto mode = kind == DjiCommand::kCurrent ? ControlMode::kCurrent : ControlMode::kVoltage;
    ASSERT_TRUE(motors.back()->setTarget({.mode = mode, .value = effort}));
    motors.back()->update(Tick{});
  }
  std::array<CanFrame, 1> packed{};
  ASSERT_EQ(group.packCommand(Tick{}, packed), 1U);
  EXPECT_EQ(packed[0].id, expected.id);
  EXPECT_EQ(packed[0].length, expected.length);
  EXPECT_EQ(packed[0].data, expected.data);
}

double reading(const DJI_Motor& motor, const std::string& name) {
  const MotorFeedback& feedback = motor.feedback();
  if (name == "velocity_rpm") return static_cast<double>(feedback.velocity_rpm);
  if (name == "current_a") return static_cast<double>(feedback.current_a);
  if (name == "torque_nm") return static_cast<double>(feedback.torque_nm);
  if (name == "temperature_c") return static_cast<double>(feedback.temperature_c);
  if (name == "angle_deg") return static_cast<double>(feedback.angle_deg);
  ADD_FAILURE() << "unknown reading " << name;
  return 0.0;
}

/// The rotor's angle shows in the way back to raw position 0, modulo a rotor turn.
double rotorDegrees(DJI_Motor& motor) {
  const double before = motor.feedback().total_angle_deg;
  EXPECT_EQ(motor.updateFeedback(makeDjiFeedback(motor.model(), motor.driveId(), {})),
            FrameVerdict::kAccepted);
  const double moved = (before - motor.feedback().total_angle_deg) * motor.get_GearRatio();
  return moved - 360.0 * std::floor(moved / 360.0 + 1e-9);
}

void checkFeedback(std::istream& line) {
  std::string model_name;
  int id = 0;
  std::string text;
  line >> model_name >> id >> text;
  const DjiModel* model = findDjiModel(model_name);
  ASSERT_NE(model, nullptr);
  DJI_Motor motor(djiConfig(*model, id));
  const CanFrame frame = frameOf(text);
  ASSERT_TRUE(motor.matchesFrame(frame));
  ASSERT_EQ(motor.updateFeedback(frame), FrameVerdict::kAccepted);
  const Values values = parseValues(line);
  ASSERT_FALSE(values.empty());
  for (const auto& [name, expected] : values) {
    if (name == "rotor_deg") continue;  // moves the motor: last
    if (std::isnan(expected)) {
      EXPECT_TRUE(std::isnan(reading(motor, name))) << name;
    } else {
      EXPECT_NEAR(reading(motor, name), expected, 1e-4 * std::max(1.0, std::abs(expected))) << name;
    }
  }
  for (const auto& [name, expected] : values) {
    if (name != "rotor_deg") continue;
    EXPECT_NEAR(rotorDegrees(motor), expected, 1e-4);
  }
}

TEST(DjiGolden, EveryPublishedFrameIsPackedAndDecodedAsDocumented) {
  std::ifstream file(std::string{RC10_SOURCE_DIR} + "/tests/golden/dji.txt");
  ASSERT_TRUE(file.is_open());
  int frames = 0;
  for (std::string text; std::getline(file, text);) {
    if (text.empty() || text.front() == '#') continue;
    SCOPED_TRACE(text);
    std::istringstream line(text);
    std::string kind;
    line >> kind;
    if (kind == "command") {
      checkCommand(line);
    } else if (kind == "feedback") {
      checkFeedback(line);
    } else {
      ADD_FAILURE() << "neither command nor feedback";
    }
    ++frames;
  }
  EXPECT_GE(frames, 13);
}

}  // namespace
}  // namespace rc10::test::dji_golden_test
