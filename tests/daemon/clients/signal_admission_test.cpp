#include "daemon/clients/signal_admission.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "daemon/described_robot.hpp"

namespace rc10::test::signal_admission_test {
namespace {

using namespace std::chrono_literals;

constexpr MonotonicTime kNow{1000s};

link::Signals message(std::string_view module = "base", std::string_view input = "vx_m_s",
                      double value = 0.5) {
  static std::int64_t seq = 0;
  link::Signals message;
  message.client = "planner";
  message.session = 1;
  message.seq = ++seq;
  message.priority = 4;
  message.received_ns = kNow.time_since_epoch().count();
  message.module = module;
  message.value_count = 1;
  message.values[0].name = input;
  message.values[0].value = value;
  return message;
}

class SignalAdmissionTest : public ::testing::Test {
 protected:
  CommandRefusal admit(const link::Signals& message, MonotonicTime now = kNow) {
    return admission_.admit(message, {}, now, out_);
  }

  static RobotDescription described() {
    RobotDescription robot;
    addModule(robot, "base", {"vx_m_s", "vy_m_s"});
    addModule(robot, "arm", {"angle_deg"});
    return robot;
  }
  RobotDescription robot_ = described();
  SignalAdmission admission_{robot_};
  SignalMessage out_;
};

TEST_F(SignalAdmissionTest, NamesBecomePlacesAndTheRestIsNotGiven) {
  ASSERT_EQ(admit(message("arm", "angle_deg", 30.0)), CommandRefusal::kNone);
  EXPECT_EQ(out_.module, 1);
  EXPECT_EQ(out_.values[0], 30.0);
  EXPECT_TRUE(std::isnan(out_.values[1]));
  EXPECT_EQ(out_.client.view(), "planner");
  EXPECT_EQ(out_.priority, 4);
  EXPECT_EQ(out_.received, kNow);
  EXPECT_EQ(out_.deadline, kNow + 50ms);
}

TEST_F(SignalAdmissionTest, RefusesWhatTheModuleDoesNotHave) {
  EXPECT_EQ(admit(message("bass")), CommandRefusal::kUnknownModule);
  EXPECT_EQ(admit(message("base", "vx")), CommandRefusal::kUnknownSignal);
}

TEST_F(SignalAdmissionTest, RefusesValuesThatAreNotFinite) {
  EXPECT_EQ(admit(message("base", "vx_m_s", std::nan(""))), CommandRefusal::kNotFinite);
  EXPECT_EQ(admit(message("base", "vx_m_s", std::numeric_limits<double>::infinity())),
            CommandRefusal::kNotFinite);
}

TEST_F(SignalAdmissionTest, RefusesAnInputTwiceNoneAtAllAndAnImpossibleValidity) {
  auto twice = message();
  twice.value_count = 2;
  twice.values[1] = twice.values[0];
  EXPECT_EQ(admit(twice), CommandRefusal::kMalformed);
  auto none = message();
  none.value_count = 0;
  EXPECT_EQ(admit(none), CommandRefusal::kMalformed);
  auto eternal = message();
  eternal.validity_ms = 1001;
  EXPECT_EQ(admit(eternal), CommandRefusal::kMalformed);
}

TEST_F(SignalAdmissionTest, RefusesWhatIsTooOld) {
  EXPECT_EQ(admit(message(), kNow + 50ms), CommandRefusal::kExpired);
}

TEST_F(SignalAdmissionTest, OneThatIsLateIsTheNewestOfItsSessionOnce) {
  ASSERT_EQ(admit(message()), CommandRefusal::kNone);
  EXPECT_FALSE(admission_.lateButNew());
  const auto late = message();
  ASSERT_EQ(admit(late, kNow + 50ms), CommandRefusal::kExpired);
  EXPECT_TRUE(admission_.lateButNew());
  EXPECT_EQ(out_.deadline, kNow + 50ms);
  ASSERT_EQ(admit(late, kNow + 50ms), CommandRefusal::kExpired) << "a replay";
  EXPECT_FALSE(admission_.lateButNew());
  auto again = late;
  again.received_ns = (kNow + 50ms).time_since_epoch().count();
  EXPECT_EQ(admit(again, kNow + 50ms), CommandRefusal::kOldSequence) << "its number is used";
}

TEST_F(SignalAdmissionTest, AClientThatFloodsLeavesRoomForAnother) {
  auto now = kNow;
  int flood = 0;
  for (int ms = 0; ms < 100; ++ms, now += 1ms) {
    for (int i = 0; i < 200; ++i) {
      auto signals = message();
      signals.received_ns = now.time_since_epoch().count();
      flood += admit(signals, now) == CommandRefusal::kNone ? 1 : 0;
    }
    auto other = message();
    other.client = std::string_view{"keyboard"};
    other.received_ns = now.time_since_epoch().count();
    EXPECT_EQ(admission_.admit(other, {.connection = 1}, now, out_), CommandRefusal::kNone) << ms;
  }
  EXPECT_LE(flood, 64 + 100 * 32);  // a burst, and what is left of the ring's share in each millisecond
  EXPECT_EQ(admit(message(), kNow), CommandRefusal::kRingFull);
}

TEST_F(SignalAdmissionTest, NumbersRiseForEachModule) {
  auto first = message();
  ASSERT_EQ(admit(first), CommandRefusal::kNone);
  EXPECT_EQ(admit(first), CommandRefusal::kOldSequence);
  auto other = message("arm", "angle_deg");
  other.seq = first.seq;
  EXPECT_EQ(admit(other), CommandRefusal::kNone) << "another module, another channel";
}

}  // namespace
}  // namespace rc10::test::signal_admission_test
