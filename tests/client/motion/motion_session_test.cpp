#include "client/motion/motion_session.hpp"

#include <chrono>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/fake_rc10d.hpp"

namespace rc10::client::test::motion_session_test {
namespace {

using namespace std::chrono_literals;
using rc10::test::FakeRc10d;
using rc10::test::heroWelcome;
using testing::HasSubstr;

MotionSettings stepOfYaw() {
  return {.client = "web-1",
          .motor = "yaw",
          .mode = ControlMode::kVelocity,
          .excitation = {.kind = ExcitationKind::kStep, .amplitude = 30.0, .time_s = 1.0},
          .criteria = {.velocity_max_rpm = 100.0, .current_max_a = 3.0},
          .validity_ms = 200};
}

/// rc10d with yaw ACTIVE and at rest, and a session whose first target is due.
class Begun {
 public:
  Begun() {
    auto welcome = heroWelcome();
    welcome.motors[1].modes = ModeSet(ControlMode::kVelocity).bits();
    client_.emplace(rc10d.welcomed(welcome));
    run_.emplace(*MotionRun::of(welcome, stepOfYaw()));
    session_.emplace(*client_, *run_, 0);
    link::TraceChoice choice;
    EXPECT_TRUE(rc10d.receive(choice));
    link::State state;
    state.motor_count = 2;
    state.robot_state = RobotStatus::kRun;
    state.motors[1].status = MotorStatus::kActive;
    rc10d.send(state);
    link::Trace trace;
    trace.signal_count = choice.signal_count;
    trace.signals = choice.signals;
    trace.row_count = 1;
    trace.rows[0].mono_us = 1;
    rc10d.send(trace);
    session_->receive();
  }

  /// The validity of the target that is sent in this turn; nothing: none is.
  std::optional<std::int32_t> sentBy(MonotonicTime now, MonotonicTime until) {
    session_->send(now, until);
    link::Command command;
    if (!rc10d.receive(command)) return std::nullopt;
    EXPECT_EQ(command.client.view(), "web-1");
    EXPECT_EQ(command.setpoints[0].motor.view(), "yaw");
    return command.validity_ms;
  }

  MotionRun& run() { return *run_; }
  MotionSession& session() { return *session_; }
  FakeRc10d rc10d;

 private:
  std::optional<LinkClient> client_;
  std::optional<MotionRun> run_;
  std::optional<MotionSession> session_;
};

TEST(MotionSession, ATargetIsValidForItsTime) {
  Begun test;
  EXPECT_EQ(test.sentBy(MonotonicTime{10s}, MonotonicTime::max()), 200);
}

TEST(MotionSession, NoTargetOutlivesTheTimeThatItIsGiven) {
  Begun test;
  const MonotonicTime until{10'090ms};
  EXPECT_EQ(test.sentBy(MonotonicTime{10s}, until), 90);
  EXPECT_EQ(test.sentBy(MonotonicTime{10'080ms}, until), 10);
  EXPECT_EQ(test.sentBy(MonotonicTime{10'089'500us}, until), std::nullopt);
  EXPECT_EQ(test.sentBy(MonotonicTime{10'200ms}, until), std::nullopt);
  // The target that lets the motor go is not sent either.
  test.run().end(Criterion::kSilence, "no word");
  EXPECT_EQ(test.sentBy(MonotonicTime{10'210ms}, until), std::nullopt);
}

TEST(MotionSession, TheEndLetsTheMotorGoWithinAMillisecond) {
  Begun test;
  EXPECT_EQ(test.sentBy(MonotonicTime{10s}, MonotonicTime::max()), 200);
  test.run().end(Criterion::kInterrupted, "stopped");
  EXPECT_EQ(test.sentBy(MonotonicTime{10'001ms}, MonotonicTime::max()), 1);
  EXPECT_EQ(test.sentBy(MonotonicTime{10'003ms}, MonotonicTime::max()), std::nullopt);
}

TEST(MotionSession, TheEndOfRc10dEndsTheTest) {
  Begun test;
  test.rc10d.end();
  test.session().receive();
  ASSERT_TRUE(test.run().aborted());
  EXPECT_EQ(test.run().aborted()->criterion, Criterion::kConnection);
  EXPECT_THAT(test.run().aborted()->text, HasSubstr("rc10d has ended"));
}

}  // namespace
}  // namespace rc10::client::test::motion_session_test
