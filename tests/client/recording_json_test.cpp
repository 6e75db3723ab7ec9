#include "client/recording_json.hpp"

#include <gmock/gmock.h>

#include <limits>

#include <nlohmann/json.hpp>

#include "app/event_code.hpp"
#include "blackbox/memory_box.hpp"
#include "client/recording_text.hpp"

namespace rc10::test::recording_json_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class RecordingJsonTest : public ::testing::Test {
 protected:
  RecordingJsonTest() { box.head().control.wall_offset_ns = 1'000'000'000'000; }

  template <typename T>
  json lineOf(T record, std::size_t bytes = sizeof(T)) {
    record.header.time_ns = 7000;
    auto out = box.handOff();
    out.write(record, bytes);
    const auto recording = box.recording();
    const auto line = client::recordJson(recording, recording.at(0));
    EXPECT_THAT(line, Not(HasSubstr("\n")));
    return json::parse(line);
  }

  MemoryBox box;
};

TEST_F(RecordingJsonTest, EveryLineHasItsTimeOnBothClocks) {
  const auto line = lineOf(blackbox::Robot{});
  EXPECT_EQ(line["utime"], 1'000'000'007);
  EXPECT_EQ(line["mono_us"], 7);
  EXPECT_EQ(line["kind"], "robot");
  EXPECT_EQ(line["state"], "RUN");
}

TEST_F(RecordingJsonTest, AFrameSaysWhereItWent) {
  blackbox::Frame frame = numberedFrame(1);
  frame.header.flags |= blackbox::kFrameSent | blackbox::kFrameRefused;
  const auto line = lineOf(frame, kNumberedFrameBytes);
  EXPECT_EQ(line["kind"], "frame");
  EXPECT_EQ(line["bus"], "chassis");
  EXPECT_EQ(line["direction"], "sent");
  EXPECT_EQ(line["accepted"], false);
  EXPECT_EQ(line["frame"], "201#0100000000000000");
}

TEST_F(RecordingJsonTest, ACommandSaysWhatBecameOfIt) {
  blackbox::Command command;
  command.client = "planner";
  command.header.flags = static_cast<std::uint8_t>(blackbox::Verdict::kNotOwner);
  command.header.id = 2;
  const auto line = lineOf(command);
  EXPECT_EQ(line["kind"], "command");
  EXPECT_EQ(line["client"], "planner");
  EXPECT_EQ(line["verdict"], "not owner");
  EXPECT_EQ(line["setpoints"], 2);
}

TEST_F(RecordingJsonTest, InputsOfAModuleHaveTheirNames) {
  blackbox::Signals signals;
  signals.client = "planner";
  signals.header.id = 0b101;
  signals.values[0] = 0.5;
  signals.values[1] = 30.0;
  signals.session = 7;
  const auto line = lineOf(signals, blackbox::signalsBytes(2));
  EXPECT_EQ(line["kind"], "signals");
  EXPECT_EQ(line["module"], "base");
  EXPECT_EQ(line["client"], "planner");
  EXPECT_EQ(line["verdict"], "applied");
  EXPECT_EQ(line["inputs"], (json{{"vx_m_s", 0.5}, {"wz_deg_s", 30.0}}));
}

TEST_F(RecordingJsonTest, InputsOfAModuleThatNobodyKnowsHaveNoNames) {
  blackbox::Signals signals;
  signals.header.source = 9;
  signals.header.id = 0xFFFFFFFF;
  const auto line = lineOf(signals, blackbox::signalsBytes(0));
  EXPECT_EQ(line["module"], "?");
  EXPECT_EQ(line["inputs"], (json{{"?", 0.0}}));
}

TEST_F(RecordingJsonTest, AnEventOfAModuleNamesTheModule) {
  blackbox::Event event;
  event.header.source = 0;
  event.header.id = 109;
  EXPECT_EQ(lineOf(event)["source"], "base");
}

TEST_F(RecordingJsonTest, APlainSetpointHasNoFeedForward) {
  blackbox::Setpoint setpoint;
  setpoint.header.source = 1;
  setpoint.header.id = 2;
  setpoint.value = 60.0;
  const auto line = lineOf(setpoint, blackbox::kPlainSetpointBytes);
  EXPECT_EQ(line["motor"], "right");
  EXPECT_EQ(line["mode"], "velocity");
  EXPECT_EQ(line["value"], 60.0);
  EXPECT_EQ(line["skipped"], false);
  EXPECT_FALSE(line.contains("torque_ff_nm"));
}

TEST_F(RecordingJsonTest, AFullSetpointHasAll) {
  blackbox::Setpoint setpoint;
  setpoint.torque_ff_nm = 0.1F;
  EXPECT_EQ(lineOf(setpoint)["torque_ff_nm"], 0.1);
}

TEST_F(RecordingJsonTest, ARequestNamesItsMotors) {
  blackbox::Order order;
  order.header.flags = 4;
  order.motors[0] = 0b10;
  order.value = 90.0;
  const auto line = lineOf(order);
  EXPECT_EQ(line["kind"], "request");
  EXPECT_EQ(line["operation"], "zero");
  EXPECT_EQ(line["motors"], json::array({"right"}));
  order.header.flags = 7;
  EXPECT_EQ(lineOf(order)["operation"], "enable_alone");
}

TEST_F(RecordingJsonTest, AnEventIsInWords) {
  blackbox::Event event;
  event.header.id = 100;
  event.header.source = 0;
  event.header.flags = 2;
  event.value = 4;
  event.extra = 3;
  const auto line = lineOf(event);
  EXPECT_EQ(line["severity"], "error");
  EXPECT_EQ(line["source"], "left");
  EXPECT_EQ(line["text"], "ACTIVE -> FAULT");
}

TEST_F(RecordingJsonTest, WhatAMotorDoesNotReportIsNull) {
  blackbox::Motor motor;
  motor.header.flags = 3;
  motor.header.id = 2 | 1U << 8U | 1U << 16U;
  motor.voltage_v = std::numeric_limits<float>::quiet_NaN();
  motor.current_a = 0.1F;
  motor.limits = 1;
  const auto line = lineOf(motor);
  EXPECT_EQ(line["status"], "ACTIVE");
  EXPECT_EQ(line["mode"], "velocity");
  EXPECT_EQ(line["command_unit"], "A");
  EXPECT_EQ(line["zeroed"], true);
  EXPECT_EQ(line["voltage_v"], nullptr);
  EXPECT_EQ(line["current_a"], 0.1);
  EXPECT_EQ(line["limits"], json::array({"current"}));
}

TEST_F(RecordingJsonTest, NumbersThatHaveNoWordAreUnknown) {
  blackbox::Bus bus;
  bus.header.source = 99;
  bus.header.flags = 99;
  const auto line = lineOf(bus);
  EXPECT_EQ(line["bus"], "?");
  EXPECT_EQ(line["state"], "unknown");
  EXPECT_EQ(line["tec"], nullptr);
}

TEST_F(RecordingJsonTest, TheFirstLineSaysWhatWasRecorded) {
  const auto line = json::parse(client::recordingJson(box.recording()));
  EXPECT_EQ(line["kind"], "recording");
  EXPECT_EQ(line["robot"], "hero");
  EXPECT_EQ(line["motors"][1]["name"], "right");
  EXPECT_EQ(line["buses"][0]["interface"], "can0");
}

TEST_F(RecordingJsonTest, TheSummarySaysHowItEnded) {
  EXPECT_THAT(client::recordingText(box.recording(), true), HasSubstr("still recording"));
  EXPECT_THAT(client::recordingText(box.recording(), false), HasSubstr("crashed or was killed"));
  box.head().control.ended = 1;
  EXPECT_THAT(client::recordingText(box.recording(), false), HasSubstr("stopped in good order"));
  box.head().header.cause = "estop";
  EXPECT_THAT(client::recordingText(box.recording(), true), HasSubstr("because of: estop"));
}

TEST_F(RecordingJsonTest, TheSummaryCountsAndShowsTheLastEvents) {
  auto out = box.handOff();
  for (std::uint64_t i = 0; i < 5; ++i) {
    auto frame = numberedFrame(i * 500'000);
    out.write(frame, kNumberedFrameBytes);
  }
  blackbox::Event event;
  event.header.id = 200;
  event.header.source = blackbox::kNoSource;
  event.value = 1;
  event.header.time_ns = 3'000'000'000;
  out.write(event);
  const auto text = client::recordingText(box.recording(), false);
  EXPECT_THAT(text, HasSubstr("robot hero"));
  EXPECT_THAT(text, HasSubstr("1970-01-01 00:16:40.000000 to 1970-01-01 00:16:43.000000 UTC: 3.0 s"));
  EXPECT_THAT(text, ::testing::ContainsRegex("frames received +5\n"));
  EXPECT_THAT(text, ::testing::ContainsRegex("info +robot +RUN -> ESTOP"));
}

TEST_F(RecordingJsonTest, AnEventThatRepeatsIsShownOnceWithItsCount) {
  auto out = box.handOff();
  blackbox::Event event;
  event.header.id = static_cast<std::uint32_t>(EventCode::kEstopInput);
  event.value = 2;
  out.write(event, sizeof event);
  event.header.id = static_cast<std::uint32_t>(EventCode::kSetpointSkipped);
  event.value = static_cast<std::int32_t>(SkipReason::kNoReference);
  for (std::uint16_t i = 0; i < 40; ++i) {
    event.header.source = i % 2;
    out.write(event, sizeof event);
  }
  const auto text = client::recordingText(box.recording(), false);
  EXPECT_THAT(text, HasSubstr("e-stop: the input is open"));
  EXPECT_THAT(text, ::testing::ContainsRegex("skipped.*\\(20 times\\)\n.*skipped.*\\(20 times\\)\n"));
}

TEST_F(RecordingJsonTest, MissedTicksDoNotCrowdOutWhatHappened) {
  auto out = box.handOff();
  const auto write = [&out](EventCode code, std::int32_t value) {
    blackbox::Event event;
    event.header.id = static_cast<std::uint32_t>(code);
    event.value = value;
    out.write(event, sizeof event);
  };
  write(EventCode::kEstopInput, 2);
  for (int i = 0; i < 20; ++i) write(EventCode::kTicksMissed, 3);
  const auto text = client::recordingText(box.recording(), false);
  EXPECT_THAT(text, HasSubstr("e-stop: the input is open"));
  EXPECT_THAT(text, Not(HasSubstr("3 ticks missed")));
  EXPECT_THAT(text, ::testing::ContainsRegex("ticks missed +60\n"));
}

}  // namespace
}  // namespace rc10::test::recording_json_test
