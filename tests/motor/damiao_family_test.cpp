// Damiao motors in the configuration.
#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <sys/socket.h>

#include "drives/damiao/damiao_family.hpp"
#include "support/damiao_motors.hpp"

namespace rc10::test::damiao_family_test {
namespace {

std::string problemOf(const MotorSettings& settings) {
  const auto checked = damiaoFamily().check(settings);
  return checked ? std::string{} : checked.error().message;
}

TEST(DamiaoFamily, EveryModelHasATableThatMakesSense) {
  std::set<std::string_view> names;
  for (const auto& model : damiaoModels()) {
    SCOPED_TRACE(model.name);
    EXPECT_TRUE(names.insert(model.name).second);
    EXPECT_GT(model.torque_nm_per_a, 0.0F);
    EXPECT_GT(model.current_max_a, 0.0F);
    EXPECT_GE(model.gear_ratio, 1.0);
    EXPECT_LE(model.gains.angle_stiffness_nm_per_rad, damiao::kKpMax);
    EXPECT_LE(model.gains.angle_damping_nms_per_rad, damiao::kKdMax);
    EXPECT_LE(model.gains.velocity_damping_nms_per_rad, damiao::kKdMax);
    // Full current is about full scale of torque: no figure has slipped by a digit.
    const double full_nm = static_cast<double>(model.torque_nm_per_a * model.current_max_a);
    EXPECT_GT(full_nm, 0.6 * model.scale.t_max_nm);
    EXPECT_LT(full_nm, 1.6 * model.scale.t_max_nm);
    // It cannot turn faster than it can report.
    EXPECT_LT(static_cast<double>(model.no_load_rpm) * 0.10472, 1.3 * model.scale.v_max_rad_s);
    EXPECT_TRUE(problemOf(damiaoSettingsOf(std::string{model.name})).empty());
  }
}

TEST(DamiaoFamily, ControlDecidesModesAndFallbacks) {
  const auto of = [](const char* control) {
    return damiaoFamily().traits("DM4310", damiaoSettingsOf("DM4310", control).own);
  };
  EXPECT_TRUE(of("mit").modes.contains(ControlMode::kImpedance));
  EXPECT_TRUE(of("mit").modes.contains(ControlMode::kCurrent));
  EXPECT_EQ(of("mit").frames.damp, Provision::kFrame);
  EXPECT_FALSE(of("velocity").modes.contains(ControlMode::kTotalAngle));
  EXPECT_EQ(of("velocity").frames.hold, Provision::kUnsupported);
  EXPECT_FALSE(of("position_velocity").modes.contains(ControlMode::kVelocity));
  EXPECT_TRUE(of("force_position").modes.contains(ControlMode::kTotalAngle));
  EXPECT_EQ(of("force_position").frames.damp, Provision::kUnsupported);
  for (const char* control : {"mit", "velocity", "position_velocity", "force_position"}) {
    EXPECT_TRUE(of(control).asked && of(control).watchdog);
    EXPECT_EQ(of(control).frames.poll, Provision::kFrame);
    EXPECT_EQ(of(control).frames.enable, Provision::kFrame);
  }
}

TEST(DamiaoFamily, EveryKeySaysWhatItIs) {
  for (const auto& key : damiaoFamily().keys()) {
    EXPECT_FALSE(key.about.empty()) << key.name;
    EXPECT_TRUE(key.required || !key.default_text.empty() ||
                key.about.find("model's own") != std::string_view::npos)
        << key.name;
  }
}

TEST(DamiaoFamily, AMasterIdThatADriveWouldObeyIsRefused) {
  for (const double id : {1.0, 257.0, 1793.0, 2047.0}) {
    auto settings = damiaoSettingsOf();
    settings.own.set("master_id", id);
    EXPECT_EQ(problemOf(settings).rfind("master_id: ", 0), 0U) << id;
  }
  auto settings = damiaoSettingsOf();
  settings.own.set("master_id", 0.0);  // as it leaves the factory
  EXPECT_TRUE(problemOf(settings).empty());
}

TEST(DamiaoFamily, AWatchdogThatCommandsCannotFeedIsRefused) {
  auto settings = damiaoSettingsOf();
  settings.own.set("watchdog_ms", 20.0);
  settings.command_divider = 7;
  EXPECT_EQ(problemOf(settings).rfind("watchdog_ms: ", 0), 0U);
  settings.command_divider = 6;
  EXPECT_TRUE(problemOf(settings).empty());
}

TEST(DamiaoFamily, ACurrentLimitThatTheControlCannotKeepIsRefused) {
  for (const std::string control : {"velocity", "position_velocity"}) {
    auto settings = damiaoSettingsOf("DM4310", control);
    settings.effort_limit = 3.0F;
    EXPECT_EQ(problemOf(settings).rfind("current_limit_a: ", 0), 0U);
    settings.effort_limit = 10.261194F;
    EXPECT_TRUE(problemOf(settings).empty());
  }
}

TEST(DamiaoFamily, AGainThatTheDriveCannotBeToldIsRefused) {
  auto settings = damiaoSettingsOf();
  settings.own.set("angle_damping_nms_per_rad", 6.0);
  EXPECT_EQ(problemOf(settings), "angle_damping_nms_per_rad: the drive takes at most 5");
  settings.gear_ratio = 20.0;
  EXPECT_TRUE(problemOf(settings).empty());
}

TEST(DamiaoFamily, TheReportedCurrentEndsWhereTheConfiguredScaleDoes) {
  auto settings = damiaoSettingsOf("DM10010");
  const auto traits = [&settings] { return damiaoFamily().traits(settings.model, settings.own); };
  const float whole_a = 200.0F / traits().torque_nm_per_a;
  EXPECT_NEAR(traits().frozen_a, whole_a, 1e-3F);
  settings.own.set("t_max_nm", 20.0);
  EXPECT_NEAR(traits().frozen_a, whole_a / 10.0F, 1e-3F);
  EXPECT_NEAR(traits().frozen_a, 7.70F, 0.01F);
  EXPECT_EQ(traits().signed_a, traits().frozen_a);
}

TEST(DamiaoFamily, TheBusUseNamesEveryIdThatADriveTakesAsItsOwn) {
  const auto use = damiaoFamily().busUse(damiaoSettingsOf("DM4310", "velocity", 4));
  const auto obeys = [&use](std::uint32_t id, std::uint8_t first = 0) {
    const auto frame = damiaoFrame(id, {first, 0, 0, 0, 0, 0, 0, 0});
    return std::any_of(use.obeys.begin(), use.obeys.end(),
                       [&frame](const auto& filter) { return accepts(filter, frame); });
  };
  for (const std::uint32_t id : {0x004U, 0x104U, 0x204U, 0x304U, 0x704U}) EXPECT_TRUE(obeys(id));
  EXPECT_FALSE(obeys(0x205));
  EXPECT_TRUE(obeys(0x7FF, 4));
  EXPECT_FALSE(obeys(0x7FF, 5));
  ASSERT_EQ(use.commands.size(), 1U);
  EXPECT_EQ(use.commands[0].id, (CanId{0x204, false}));
  EXPECT_EQ(use.commands[0].shape.length, 4U);
  EXPECT_EQ(use.commands[0].per_second, 1000.0);
}

TEST(DamiaoFamily, DrivesOnOneBusMayShareAMasterId) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends), 0);
  const UniqueFd other(ends[1]);
  const auto bus = fdCANbus::adopt("bus", UniqueFd(ends[0]), false);
  BusParts parts(*bus);
  std::vector<std::unique_ptr<Motor_Base>> motors;
  for (int id = 1; id <= 3; ++id) {
    auto settings = damiaoSettingsOf("DM4310", id == 2 ? "velocity" : "mit", id);
    settings.own.set("master_id", 0.0);
    auto built = damiaoFamily().build(settings, parts);
    ASSERT_TRUE(built) << built.error().message;
    motors.push_back(std::move(*built));
  }
  for (std::uint8_t id = 1; id <= 3; ++id) {
    bus->dispatch(damiaoFrame(0, {id, 0x80, 0, 0x80, 8, 0, 20, 20}));
    EXPECT_EQ(motors[id - 1U]->feedback().samples, 1U);
  }
  EXPECT_EQ(bus->counters().rx_unmatched, 0U);
  auto again = damiaoSettingsOf("DM4310", "mit", 3);
  again.name = "again";
  EXPECT_FALSE(damiaoFamily().build(again, parts));
}

}  // namespace
}  // namespace rc10::test::damiao_family_test
