// No jump on any change of mode; no wind-up against any limit.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <gtest/gtest.h>

#include "support/simple_plant.hpp"

namespace rc10::test::dji_transition_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// The largest change of the effort from one tick to the next.
class JumpMeter {
 public:
  explicit JumpMeter(const DJI_Motor& motor) : motor_(motor), last_(motor.commandValue()) {}
  void operator()() {
    largest_ = std::max(largest_, std::abs(motor_.commandValue() - last_));
    last_ = motor_.commandValue();
  }
  [[nodiscard]] float largest() const { return largest_; }

 private:
  const DJI_Motor& motor_;
  float last_;
  float largest_ = 0.0F;
};

MotorSettings transitionConfig(bool incremental) {
  MotorSettings config = djiConfig(kM3508);
  config.zero_at_power_on = true;
  config.loops.angle.output_limit = 0.0F;
  if (incremental) config.loops.velocity = PID_Incremental::Config{.kp = 0.2F, .ki = 1.6F};
  return config;
}

class DjiTransition : public testing::TestWithParam<bool> {};

TEST_P(DjiTransition, TheEffortIsContinuousThroughEveryModeWhenTheTargetsAgree) {
  DJI_Motor motor(transitionConfig(GetParam()));
  SimplePlant plant = plantOf(kM3508);
  plant.load_nm = 1.0;  // 3.3 A that no transition may drop
  DjiBench bench(motor, plant);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{100.0}));
  bench.run(seconds{2});
  JumpMeter jumps(motor);
  const auto run = [&] { bench.run(milliseconds{5}, [&jumps] { jumps(); }); };
  // 25 deg ahead, where the angle loop asks for the same 100 rpm; the wheel moves 3 deg meanwhile.
  ASSERT_TRUE(motor.setTargetAngle(Degrees{motor.getAngle().value + 25.0}));
  run();
  ASSERT_TRUE(motor.setTargetTotalAngle(Degrees{motor.getTotalAngle().value + 25.0}));
  run();
  ASSERT_TRUE(motor.setTargetCurrent(Amperes{static_cast<double>(motor.commandValue())}));
  run();
  ASSERT_TRUE(motor.setTargetRPM(Rpm{100.0}));
  run();
  EXPECT_LT(jumps.largest(), 1.0F);  // the angle modes slow down by 12 rpm in 5 ms: 0.5 A a tick
  EXPECT_GT(motor.commandValue(), 2.0F);
}

TEST_P(DjiTransition, ALoopContinuesFromACurrentOrderedInBetween) {
  DJI_Motor motor(transitionConfig(GetParam()));
  SimplePlant plant = plantOf(kM3508);
  plant.load_nm = 1.0;
  DjiBench bench(motor, plant);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{100.0}));
  bench.run(seconds{1});
  ASSERT_TRUE(motor.setTargetCurrent(Amperes{8.0}));
  bench.run(milliseconds{5});
  JumpMeter jumps(motor);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{100.0}));
  bench.run(milliseconds{2}, [&jumps] { jumps(); });
  EXPECT_LT(jumps.largest(), 2.0F);  // of the 5 A between the two
}

TEST_P(DjiTransition, AFarTargetEntersGraduallyAfterAChangeOfMode) {
  DJI_Motor motor(transitionConfig(GetParam()));
  DjiBench bench(motor, plantOf(kM3508));
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{100.0}));
  bench.run(seconds{1});
  JumpMeter jumps(motor);
  ASSERT_TRUE(motor.setTargetTotalAngle(Degrees{motor.getTotalAngle().value - 1000.0}));
  bench.run(milliseconds{50}, [&jumps] { jumps(); });
  // From 100 to -480 rpm with 0.2 A/rpm is 116 A of proportional share: clamped to 20 A, in steps.
  EXPECT_LT(jumps.largest(), 12.0F);
}

TEST_P(DjiTransition, EnablingAtRestDoesNotKick) {
  DJI_Motor motor(transitionConfig(GetParam()));
  DjiBench bench(motor, plantOf(kM3508));
  bench.run(milliseconds{100});
  JumpMeter jumps(motor);
  for (const FrameKind kind : {FrameKind::kEnable, FrameKind::kIdle, FrameKind::kHold, FrameKind::kBrake}) {
    motor.order(kind);
    bench.run(milliseconds{50}, [&jumps] { jumps(); });
  }
  EXPECT_LT(jumps.largest(), 0.05F);
}

TEST_P(DjiTransition, AStalledWheelThatComesFreeDoesNotRunAwayByWindUp) {
  MotorSettings config = transitionConfig(GetParam());
  config.effort_limit = 3.0F;
  DJI_Motor motor(config);
  DjiBench bench(motor, plantOf(kM3508));
  motor.order(FrameKind::kCommand);
  bench.plant().coulomb_nm = 10.0;  // stuck
  ASSERT_TRUE(motor.setTargetRPM(Rpm{50.0}));
  bench.run(seconds{5});
  EXPECT_NEAR(motor.commandValue(), 3.0F, 1e-3F);
  EXPECT_NE(motor.limits() & kLimitCurrent, 0U);
  bench.plant().coulomb_nm = 0.05;
  double fastest = 0.0;
  bench.run(seconds{1}, [&] { fastest = std::max(fastest, bench.plant().rpm()); });
  EXPECT_LT(fastest, 75.0);
  EXPECT_NEAR(bench.plant().rpm(), 50.0, 1.0);
}

TEST_P(DjiTransition, ALimitThatFallsAndIsReleasedCausesNoOvershoot) {
  DJI_Motor motor(transitionConfig(GetParam()));
  SimplePlant plant = plantOf(kM3508);
  plant.load_nm = 1.0;
  DjiBench bench(motor, plant);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{100.0}));
  bench.run(seconds{1});
  motor.derate(0.175F);  // 3.5 A: hardly more than the load needs
  bench.run(seconds{1}, [&] { ASSERT_LE(std::abs(motor.commandValue()), 3.501F); });
  ASSERT_TRUE(motor.setTargetRPM(Rpm{300.0}));
  bench.run(seconds{1}, [&] { ASSERT_LE(std::abs(motor.commandValue()), 3.501F); });
  motor.derate(1.0F);
  double fastest = 0.0;
  bench.run(seconds{2}, [&] { fastest = std::max(fastest, bench.plant().rpm()); });
  EXPECT_LT(fastest, 315.0);
  EXPECT_NEAR(bench.plant().rpm(), 300.0, 2.0);
}

TEST_P(DjiTransition, LostFeedbackAndItsReturnStayWithinTheLimitAndSettle) {
  DJI_Motor motor(transitionConfig(GetParam()));
  DjiBench bench(motor, plantOf(kM3508));
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(Rpm{200.0}));
  bench.run(seconds{1});
  bench.stopFeedback(true);
  bench.run(milliseconds{300});
  EXPECT_FLOAT_EQ(motor.commandValue(), 0.0F);
  bench.stopFeedback(false);
  bench.run(seconds{1});
  EXPECT_NEAR(bench.plant().rpm(), 200.0, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Forms, DjiTransition, testing::Bool(),
                         [](const auto& each) { return each.param ? "Incremental" : "Position"; });

}  // namespace
}  // namespace rc10::test::dji_transition_test
