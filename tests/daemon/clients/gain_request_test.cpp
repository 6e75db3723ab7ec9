// `set_gains` and `get_config`: what is asked, and what the supervisor does while the motor runs.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blackbox/memory_box.hpp"
#include "config/load_config.hpp"
#include "daemon/clients/gain_request.hpp"
#include "daemon/clients/request_desk.hpp"
#include "daemon/link_messages.hpp"
#include "daemon/virtual_robot.hpp"
#include "link/until_its_end.hpp"
#include "link/words.hpp"

namespace rc10::test::gain_request_test {
namespace {

using link::ResponseStatus;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Values = std::initializer_list<std::pair<std::string_view, double>>;

RobotConfig wheelAndArm() {
  auto outcome = parseRobotConfig(
      "robot: gains\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    motors:\n"
      "      - {name: wheel, model: M3508, id: 1, zero: power_on, current_limit_a: 5, velocity_limit_rpm: "
      "100,\n"
      "         velocity_pid: {type: position, kp_a_per_rpm: 0.25, ki_a_per_rpm_s: 1},\n"
      "         angle_pid: {kp_rpm_per_deg: 3}}\n"
      "      - {name: arm, model: DM4310, id: 2, master_id: 17}\n",
      "gains.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

RobotDescription descriptionOf(const RobotConfig& config) {
  RobotDescription robot;
  for (const auto& motor : config.buses[0].motors) {
    auto& described = robot.motors.emplace_back();
    described.name = motor.name();
    described.loops = {motor.settings.model, motor.traits(), motor.settings.loops};
  }
  return robot;
}

/// A wheel with loops in rc10d and an arm without; the desk, the scheduler and the drives.
class SetGainsTest : public ::testing::Test {
 protected:
  link::Request ask(std::string_view operation, std::string_view motor, Values values = {}) {
    auto request = linkRequest(++seq_, operation, motor);
    for (const auto& [name, value] : values) request.values[request.value_count++] = {name, value};
    return request;
  }
  /// The answer of the whole daemon, link thread and scheduler.
  link::Response answer(const link::Request& request) {
    auto outcome = desk.begin(request, {.connection = 1}, kAnyTime);
    if (outcome.response) return *outcome.response;
    if (!outcome.order || !robot.exchange().orders.push(*outcome.order)) return {};
    OrderResult result;
    robot.tick();
    EXPECT_TRUE(robot.exchange().results.pop(result)) << "it is done in the next tick";
    const auto done = desk.finish(result);
    return done ? done->response : link::Response{};
  }
  link::Response set(Values values, std::string_view motor = "wheel") {
    return answer(ask(toString(Operation::kSetGains), motor, values));
  }
  std::string refusal(const link::Request& request) {
    const auto response = answer(request);
    EXPECT_EQ(response.status, ResponseStatus::kRefused);
    return std::string(response.message.view());
  }
  static std::map<std::string, double> valuesIn(const link::Response& response) {
    std::map<std::string, double> values;
    for (std::size_t i = 0; i < response.value_count; ++i)
      values[std::string(response.values[i].name.view())] = response.values[i].value;
    return values;
  }
  const CascadeConfig& loops() { return *robot.robot().motors()[0].motor->hostLoops(); }
  float effort() { return robot.motor(0).command_value; }
  void turn(double rpm, int ticks) { robot.hold(0, {.mode = ControlMode::kVelocity, .value = rpm}, ticks); }
  void enable() {
    robot.run(100);
    robot.order(Operation::kEnable);
    ASSERT_EQ(robot.motor(0).status, MotorStatus::kActive);
  }

  RobotConfig config = wheelAndArm();
  MemoryBox box;
  FlightRecorder recorder{box.handOff()};
  VirtualRobot robot{config, &recorder};
  RobotDescription description = descriptionOf(config);
  Admission admission{description};
  RequestDesk desk{admission, description};

 private:
  std::int64_t seq_ = 0;
};

TEST_F(SetGainsTest, TheGainsInForceAreTold) {
  const auto response = answer(ask(toString(Operation::kGetConfig), "wheel"));
  EXPECT_EQ(response.status, ResponseStatus::kOk);
  const auto values = valuesIn(response);
  EXPECT_EQ(values.size(), 15U);
  EXPECT_EQ(values.at("velocity_pid.kp_a_per_rpm"), 0.25);
  EXPECT_EQ(values.at("velocity_pid.ki_a_per_rpm_s"), 1.0);
  EXPECT_THAT(std::string(response.message.view()),
              HasSubstr("velocity_pid: {type: position, kp_a_per_rpm: 0.25, ki_a_per_rpm_s: 1, "));
}

TEST_F(SetGainsTest, OtherGainsAreInForceInTheNextTickAndAreTold) {
  const auto response = set({{"velocity_pid.kp_a_per_rpm", 0.3}, {"angle.kp", 4.0}});
  EXPECT_EQ(response.status, ResponseStatus::kOk);
  EXPECT_EQ(
      response.message.view(),
      "wheel: velocity_pid.kp_a_per_rpm 0.25 -> 0.3, angle_pid.kp_rpm_per_deg 3 -> 4; until rc10d restarts");
  EXPECT_EQ(valuesIn(response).at("velocity_pid.kp_a_per_rpm"), 0.3) << "as it was written, not as a float";
  EXPECT_EQ(std::get<PID_Position::Config>(loops().velocity).kp, 0.3F);
  EXPECT_EQ(loops().angle.kp, 4.0F);
  EXPECT_EQ(valuesIn(answer(ask(toString(Operation::kGetConfig), "wheel"))).at("angle_pid.kp_rpm_per_deg"),
            4.0);
}

TEST_F(SetGainsTest, ARequestActsWholeOrNotAtAll) {
  const auto before = gainOf(loops(), LoopGain::kVelocityKp);
  EXPECT_THAT(
      refusal(ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 0.5}, {"velocity.ki", -1.0}})),
      HasSubstr("wheel: velocity_pid.ki_a_per_rpm_s: -1 is below 0 A/(rpm s); use "));
  EXPECT_THAT(
      refusal(ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 0.5}, {"kp_a_per_rpm", 0.6}})),
      HasSubstr("given twice"));
  EXPECT_THAT(refusal(ask(toString(Operation::kSetGains), "wheel")), HasSubstr("name a gain"));
  robot.run(3);
  EXPECT_EQ(gainOf(loops(), LoopGain::kVelocityKp), before);
}

TEST_F(SetGainsTest, AMotorWhoseDriveClosesTheLoopsSaysSo) {
  for (const auto& request : {ask(toString(Operation::kSetGains), "arm", {{"velocity.kp", 1.0}}),
                              ask(toString(Operation::kGetConfig), "arm")})
    EXPECT_THAT(refusal(request), HasSubstr("arm: rc10d closes no loop of the DM4310: its drive does"));
  Order order;
  order.id = 77;
  order.operation = Operation::kSetGains;
  order.motors.set(1);
  order.gains.count = 1;
  robot.exchange().orders.push(order);
  robot.tick();
  OrderResult result;
  ASSERT_TRUE(robot.exchange().results.pop(result));
  EXPECT_EQ(result.motors[1], Refusal::kNoGains);
}

TEST_F(SetGainsTest, NamesOneMotor) {
  for (const auto* target : {"", "wheel,arm", "leg"}) {
    EXPECT_THAT(refusal(ask(toString(Operation::kGetConfig), target)),
                HasSubstr("the motors are: wheel, arm"));
    EXPECT_THAT(refusal(ask(toString(Operation::kSetGains), target, {{"velocity.kp", 1.0}})),
                HasSubstr("the motors are: wheel, arm"));
  }
}

TEST_F(SetGainsTest, ARepeatedRequestIsCarriedOutOnce) {
  const auto request = ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 0.5}});
  const auto first = answer(request);
  (void)set({{"velocity.kp", 0.7}});
  const auto again = answer(request);
  EXPECT_EQ(again.message.view(), first.message.view());
  EXPECT_EQ(gainOf(loops(), LoopGain::kVelocityKp), 0.7F);
}

TEST_F(SetGainsTest, OrdersOfOneTickFollowOneAnother) {
  const auto first = desk.begin(ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 0.5}}),
                                {.connection = 1}, kAnyTime);
  const auto second =
      desk.begin(ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 0.6}, {"velocity.ki", 2.0}}),
                 {.connection = 1}, kAnyTime);
  robot.exchange().orders.push(*first.order);
  robot.exchange().orders.push(*second.order);
  robot.tick();
  OrderResult result;
  std::string text;
  while (robot.exchange().results.pop(result)) text = desk.finish(result)->response.message.view();
  EXPECT_THAT(text, HasSubstr("kp_a_per_rpm 0.5 -> 0.6"));
  EXPECT_EQ(gainOf(loops(), LoopGain::kVelocityKi), 2.0F);
}

/// A client that tries gains, and the end of its connection.
class TriedGainsTest : public SetGainsTest {
 protected:
  static constexpr std::string_view kTry = link::kRestoreAtEnd;
  /// The order that is due while the clients of these connections are there.
  std::optional<Order> dueWith(std::initializer_list<std::uint64_t> open) {
    const std::set<std::uint64_t> connections{open};
    return desk.gainsForNobody([&](std::uint64_t id) { return connections.contains(id); });
  }
  void carryOut(const Order& order) {
    ASSERT_TRUE(robot.exchange().orders.push(order));
    robot.tick();
    OrderResult result;
    ASSERT_TRUE(robot.exchange().results.pop(result));
    (void)desk.finish(result);
  }
  float kp() { return gainOf(loops(), LoopGain::kVelocityKp); }
  float ki() { return gainOf(loops(), LoopGain::kVelocityKi); }
};

TEST_F(TriedGainsTest, ThoseOfBeforeTheFirstTryAreInForceAgainWhenTheConnectionHasEnded) {
  EXPECT_THAT(std::string(set({{"velocity.kp", 0.5}, {kTry, 1.0}}).message.view()),
              HasSubstr("0.25 -> 0.5; until its client ends"));
  (void)set({{"velocity.kp", 0.8}, {"velocity.ki", 2.0}, {kTry, 1.0}});
  ASSERT_EQ(kp(), 0.8F);
  EXPECT_FALSE(dueWith({1}));
  const auto order = dueWith({});
  ASSERT_TRUE(order);
  EXPECT_EQ(order->client.view(), "pilot");
  EXPECT_FALSE(dueWith({})) << "it is under way";
  carryOut(*order);
  EXPECT_EQ(kp(), 0.25F);
  EXPECT_EQ(ki(), 1.0F);
  EXPECT_EQ(valuesIn(answer(ask(toString(Operation::kGetConfig), "wheel"))).at("velocity_pid.kp_a_per_rpm"),
            0.25);
  EXPECT_FALSE(dueWith({})) << "it is done";
}

TEST_F(TriedGainsTest, AnOrderThatFoundNoRoomIsDueAgain) {
  (void)set({{"velocity.kp", 0.5}, {kTry, 1.0}});
  const auto order = dueWith({});
  ASSERT_TRUE(order);
  (void)desk.fail(order->id, "no room");
  EXPECT_TRUE(dueWith({}));
}

TEST_F(TriedGainsTest, AfterThreeRefusalsTheyAreToldOnceAndStayUntilTheyAreSet) {
  (void)set({{"velocity.kp", 0.5}, {"velocity.ki", 2.0}, {kTry, 1.0}});
  std::vector<std::string> notes;
  for (int i = 0; i < 3; ++i) {
    const auto order = dueWith({});
    ASSERT_TRUE(order) << i;
    EXPECT_THAT(desk.gainsLeft(), IsEmpty());
    OrderResult result{.id = order->id};
    result.motors[0] = Refusal::kNoGains;
    const auto done = desk.finish(result);
    ASSERT_TRUE(done);
    notes.push_back(done->note);
  }
  EXPECT_FALSE(dueWith({}));
  const std::string text =
      "wheel: gains that 'pilot' tried could not be set back: velocity_pid.kp_a_per_rpm is 0.5, not 0.25, "
      "velocity_pid.ki_a_per_rpm_s is 2, not 1: `rc10ctl gains wheel velocity_pid.kp_a_per_rpm=0.25 "
      "velocity_pid.ki_a_per_rpm_s=1`";
  EXPECT_THAT(notes, ElementsAre("", "", text));
  EXPECT_THAT(desk.gainsLeft(), ElementsAre(text));
  (void)set({{"velocity.kp", 0.25}, {"velocity.ki", 1.0}});
  EXPECT_THAT(desk.gainsLeft(), IsEmpty());
}

TEST_F(TriedGainsTest, AGainThatIsSetToStayStays) {
  (void)set({{"velocity.kp", 0.5}, {"velocity.ki", 2.0}, {kTry, 1.0}});
  (void)set({{"velocity.kp", 0.6}});
  const auto order = dueWith({});
  ASSERT_TRUE(order);
  carryOut(*order);
  EXPECT_EQ(kp(), 0.6F);
  EXPECT_EQ(ki(), 1.0F);
}

TEST_F(TriedGainsTest, OneThatSetsThemBackItselfLeavesNothingToDo) {
  (void)set({{"velocity.kp", 0.5}, {kTry, 1.0}});
  (void)set({{"velocity.kp", 0.25}});
  EXPECT_FALSE(dueWith({}));
}

TEST_F(TriedGainsTest, ItIsAskedForByOneAndNotThroughLcm) {
  EXPECT_THAT(refusal(ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 0.5}, {kTry, 2.0}})),
              HasSubstr("restore_at_end: use 1"));
  const auto outcome =
      desk.begin(ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 0.5}, {kTry, 1.0}}),
                 {.connection = 1, .way = Speaker::Way::kLcm}, kAnyTime);
  ASSERT_TRUE(outcome.response);
  EXPECT_THAT(std::string(outcome.response->message.view()),
              HasSubstr("nobody sees the end of an LCM client"));
  EXPECT_THAT(refusal(ask(toString(Operation::kSetGains), "wheel", {{kTry, 1.0}})), HasSubstr("name a gain"));
  EXPECT_EQ(kp(), 0.25F);
}

TEST_F(SetGainsTest, AFloodOfThemIsRefused) {
  for (int i = 0; i < 8; ++i) {
    EXPECT_TRUE(desk.begin(ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 0.1 * i}}),
                           {.connection = 1}, kAnyTime)
                    .order);
  }
  const auto outcome = desk.begin(ask(toString(Operation::kSetGains), "wheel", {{"velocity.kp", 1.0}}),
                                  {.connection = 1}, kAnyTime);
  ASSERT_TRUE(outcome.response);
  EXPECT_THAT(std::string(outcome.response->message.view()), HasSubstr("wait for the answers"));
  EXPECT_TRUE(desk.begin(ask("disable", "wheel"), {.connection = 1}, kAnyTime).order)
      << "other requests are taken";
}

TEST_F(SetGainsTest, AMotorThatTurnsGoesOnWithoutABump) {
  enable();
  turn(60.0, 1000);
  ASSERT_NEAR(robot.motor(0).feedback.velocity_rpm, 60.0F, 3.0F);
  const float before = effort();
  const auto outcome =
      desk.begin(ask(toString(Operation::kSetGains), "wheel", {{"velocity.ki", 20.0}, {"velocity.kp", 0.5}}),
                 {.connection = 1}, kAnyTime);
  robot.exchange().orders.push(*outcome.order);
  turn(60.0, 1);
  EXPECT_NEAR(effort(), before, 0.25F);
  turn(60.0, 500);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
  EXPECT_NEAR(robot.motor(0).feedback.velocity_rpm, 60.0F, 3.0F);
}

TEST_F(SetGainsTest, TheLimitsOfTheConfigurationStay) {
  enable();
  (void)set({{"velocity.kp", 1e6}, {"angle.kp", 1e6}, {"angle.velocity_limit", 1e5}});
  float most_a = 0.0F;
  float most_rpm = 0.0F;
  for (int i = 0; i < 300; ++i) {
    robot.hold(0, {.mode = ControlMode::kTotalAngle, .value = 36'000.0}, 1);
    most_a = std::max(most_a, std::abs(effort()));
    most_rpm = std::max(most_rpm, robot.motor(0).feedback.velocity_rpm);
  }
  EXPECT_FLOAT_EQ(most_a, 5.0F);
  EXPECT_LT(most_rpm, 115.0F);
}

TEST_F(SetGainsTest, ALeaseDoesNotStopIt) {
  enable();
  robot.commandAs("planner", 5, 0, {.mode = ControlMode::kVelocity, .value = 60.0});
  robot.tick();
  EXPECT_EQ(set({{"velocity.kp", 0.5}}).status, ResponseStatus::kOk);
  EXPECT_EQ(robot.motor(0).owner.view(), "planner");
}

TEST_F(SetGainsTest, EveryChangeIsAnEventAndInTheBlackBox) {
  (void)robot.events();
  (void)set({{"velocity.kp", 0.5}, {"velocity.ki", 1.0}});
  const auto events = robot.events();
  ASSERT_EQ(events.size(), 1U) << "ki is what it was";
  EXPECT_EQ(events[0].code, EventCode::kGainChanged);
  EXPECT_EQ(events[0].source, 0);
  EXPECT_EQ(describe(events[0]), "velocity_pid.kp_a_per_rpm is 0.5 now, set by 'pilot'");
  EXPECT_EQ(all<blackbox::Order>(box.recording()).back().header.flags,
            static_cast<std::uint8_t>(Operation::kSetGains));
  EXPECT_EQ(all<blackbox::Event>(box.recording()).back().header.id, 110U);
}

TEST_F(SetGainsTest, TheWordsOfTheEventAreTheKeysOfTheConfiguration) {
  for (const auto& gain : allGainKeys()) {
    const bool volts = (gain.key->needs & kNeedsVoltage) != 0;
    EXPECT_EQ(link::gainWord(static_cast<std::int32_t>(gain.gain) + (volts ? kGainInVolts : 0)), gain.path());
  }
}

TEST_F(SetGainsTest, IsRefusedWhileRc10dStops) {
  robot.scheduler().beginStop();
  robot.tick();
  const auto response = set({{"velocity.kp", 0.5}});
  EXPECT_EQ(response.status, ResponseStatus::kFailed);
  EXPECT_THAT(std::string(response.message.view()), HasSubstr("rc10d is stopping"));
}

TEST_F(SetGainsTest, TheApproachToASoftLimitIsThatOfTheNewGain) {
  auto soft = config;
  soft.buses[0].motors[0].shaping.angle_max_deg = 90.0;
  for (const double kp : {1.0, 8.0}) {
    VirtualRobot limited(soft);
    limited.run(100);
    limited.order(Operation::kEnable);
    Order order;
    order.id = 500;
    order.operation = Operation::kSetGains;
    order.motors.set(0);
    order.gains.count = 1;
    order.gains.values[0] = {LoopGain::kAngleKp, static_cast<float>(kp)};
    limited.exchange().orders.push(order);
    float fastest_rpm = 0.0F;
    for (int i = 0; i < 1000; ++i) {
      limited.hold(0, {.mode = ControlMode::kVelocity, .value = 100.0}, 1);
      fastest_rpm = std::max(fastest_rpm, limited.motor(0).feedback.velocity_rpm);
    }
    // 0.5 rpm for each degree and for each rpm per degree of gain
    EXPECT_EQ(fastest_rpm < 46.0F, kp == 1.0) << fastest_rpm;
  }
}

}  // namespace
}  // namespace rc10::test::gain_request_test
