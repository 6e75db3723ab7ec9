#include "client/state_json.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fake_rc10d.hpp"
#include "sample_messages.hpp"

namespace rc10::client::test::state_json_test {
namespace {

using nlohmann::json;
using rc10::test::heroDiagnostics;
using rc10::test::heroState;
using rc10::test::heroWelcome;

TEST(ListJson, IsOneLineWithEveryMotor) {
  const auto text = listJson(heroWelcome());
  EXPECT_EQ(text.find('\n'), std::string::npos);
  const auto parsed = json::parse(text);
  EXPECT_EQ(parsed["robot"], "hero");
  ASSERT_EQ(parsed["motors"].size(), 2U);
  EXPECT_EQ(parsed["motors"][0]["name"], "front_left");
  EXPECT_EQ(parsed["motors"][0]["modes"], (json{"current", "velocity"}));
}

TEST(StateJson, HasTheFieldsOfTheLcmTypes) {
  const auto parsed = json::parse(stateJson(heroWelcome(), heroState()));
  EXPECT_EQ(parsed["tick"], 41'000);
  EXPECT_EQ(parsed["state"], "RUN");
  EXPECT_EQ(parsed["realtime"], true);
  const auto& wheel = parsed["motors"][0];
  EXPECT_EQ(wheel["status"], "ACTIVE");
  EXPECT_EQ(wheel["mode"], "velocity");
  EXPECT_EQ(wheel["target"], 120.0);
  EXPECT_EQ(wheel["owner"], "teleop");
  EXPECT_EQ(wheel["zeroed"], false);
  EXPECT_EQ(wheel["limits"], json::array({"current"}));
  EXPECT_EQ(wheel["command_unit"], "A");
  EXPECT_EQ(wheel["velocity_rpm"], 118.26) << "the float's digits, not those of the double beside it";
}

TEST(StateJson, WhatIsNotReportedIsNull) {
  const auto parsed = json::parse(stateJson(heroWelcome(), heroState()));
  EXPECT_TRUE(parsed["motors"][0]["voltage_v"].is_null());
  EXPECT_TRUE(parsed["motors"][1]["velocity_rpm"].is_null());
  EXPECT_TRUE(parsed["motors"][1]["total_angle_deg"].is_null());
  EXPECT_EQ(parsed["motors"][1]["fault_text"], "fault 12");
}

TEST(StateJson, SurvivesNamesThatAreNotUtf8) {
  auto state = heroState();
  state.motors[0].owner = "a\"b\\c\n\xff\xfe";
  const auto parsed = json::parse(stateJson(heroWelcome(), state));
  EXPECT_EQ(parsed["motors"][0]["owner"].get<std::string>().substr(0, 6), "a\"b\\c\n");
}

TEST(StateJson, DoesNotBelieveTheCounts) {
  auto state = heroState();
  auto welcome = heroWelcome();
  state.motor_count = welcome.motor_count = 0xFFFFFFFF;
  EXPECT_EQ(json::parse(stateJson(welcome, state))["motors"].size(), link::kMaxMotors);
}

TEST(DiagnosticsJson, HasTimingBusesAndRefusals) {
  const auto parsed = json::parse(diagnosticsJson(heroWelcome(), heroDiagnostics()));
  EXPECT_EQ(parsed["wake_latency_us"]["p99"], 38.5);
  EXPECT_EQ(parsed["missed_ticks"], 2);
  EXPECT_EQ(parsed["refusals"]["expired"], 3);
  EXPECT_EQ(parsed["notices"][0], "not real-time: no permission");
  EXPECT_EQ(parsed["buses"][0]["state"], "warning");
  EXPECT_EQ(parsed["buses"][0]["tec"], 96);
  EXPECT_TRUE(parsed["buses"][0]["rec"].is_null());
  EXPECT_EQ(parsed["buses"][0]["predicted_load"], 0.556);
}

}  // namespace
}  // namespace rc10::client::test::state_json_test
