#include "sim/sim_bus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "drives/dji/dji_simulated.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::sim_bus_test {
namespace {

using namespace std::chrono_literals;
using sim::DjiDrive;
using sim::djiDrive;
using sim::MotorLoad;
using sim::SimBus;
using sim::SimBusConfig;

SimBusConfig mixedBus(std::uint64_t seed = 1, float lost_frames = 0.0F) {
  MotorLoad load;
  load.lost_frames = lost_frames;
  SimBusConfig config;
  config.seed = seed;
  config.drives = {djiDrive({"wheel", &kM3508, 1, DjiCommand::kCurrent, 0.0, load}),
                   djiDrive({"feeder", &kM2006, 2, DjiCommand::kCurrent, 0.0, load}),
                   djiDrive({"yaw", &kGM6020, 5, DjiCommand::kCurrent, 0.0, load}),
                   djiDrive({"pitch", &kGM6020, 6, DjiCommand::kVoltage, 0.0, load})};
  return config;
}

/// A bus in virtual time, and everything that its drives said.
class Recorder {
 public:
  explicit Recorder(const SimBusConfig& config)
      : bus_(config), per_drive_(bus_.size()), out_(SimBus::kMaxFramesPerStep) {}

  SimBus& bus() { return bus_; }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }
  [[nodiscard]] std::uint64_t heard(std::size_t drive) const { return per_drive_[drive]; }

  std::size_t step(Duration dt = 1ms) {
    now_ += dt;
    const std::size_t count = bus_.step(now_, dt, out_);
    for (const CanFrame& frame : std::span(out_).first(count)) {
      EXPECT_EQ(frame.received, now_);
      mix(frame.id.value);
      for (const std::uint8_t byte : frame.payload()) mix(byte);
      for (std::size_t i = 0; i < bus_.size(); ++i) {
        if (bus_.drive(i).sends().front().id == frame.id) ++per_drive_[i];
      }
    }
    mix(count);
    return count;
  }

  /// All motors follow currents that keep changing.
  void drive(Duration duration, const std::function<void(int)>& each_ms = {}) {
    for (int ms = 0; ms < duration / 1ms; ++ms) {
      const auto raw = static_cast<std::int16_t>(std::lround(6000.0 * std::sin(0.003 * ms)));
      const auto high = static_cast<std::uint8_t>(static_cast<std::uint16_t>(raw) >> 8U);
      const auto low = static_cast<std::uint8_t>(static_cast<std::uint16_t>(raw) & 0xFFU);
      for (const std::uint32_t id : {0x200U, 0x2FEU, 0x2FFU}) {
        bus_.receive(makeClassicFrame({id, false}, std::array{high, low, low, low, high, low, low, low}));
      }
      if (each_ms) each_ms(ms);
      step();
    }
  }

 private:
  void mix(std::uint64_t value) { hash_ = (hash_ ^ value) * 0x100'0000'01B3U; }

  SimBus bus_;
  std::vector<std::uint64_t> per_drive_;
  std::vector<CanFrame> out_;
  MonotonicTime now_{100s};
  std::uint64_t hash_ = 0xCBF2'9CE4'8422'2325U;
};

TEST(SimBus, OneSeedGivesTheSameBytesOver60Seconds) {
  Recorder one{mixedBus(7, 0.1F)};
  Recorder two{mixedBus(7, 0.1F)};
  Recorder other_seed{mixedBus(8, 0.1F)};
  for (Recorder* recorder : {&one, &two, &other_seed}) recorder->drive(60s);
  EXPECT_EQ(one.hash(), two.hash());
  EXPECT_NE(one.hash(), other_seed.hash());
}

TEST(SimBus, EveryDriveSpeaksOncePerMillisecondUnasked) {
  Recorder recorder{mixedBus()};
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(recorder.step(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(recorder.heard(i), 1000U);
}

TEST(SimBus, ShorterStepsDoNotMakeItSpeakMoreOften) {
  Recorder recorder{mixedBus()};
  for (int i = 0; i < 4000; ++i) recorder.step(250us);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(recorder.heard(i), 1000U);
}

TEST(SimBus, StepsThatComeEarlyOrLateStillGiveOneFrameEach) {
  Recorder recorder{mixedBus()};
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(recorder.step(i % 2 == 0 ? 610us : 1390us), 4U) << i;
  }
  EXPECT_EQ(recorder.bus().counters().overslept, 0U);
}

TEST(SimBus, ALongStepGivesOneFrameOfEachDriveAndCountsTheRest) {
  Recorder recorder{mixedBus()};
  EXPECT_EQ(recorder.step(10ms), 4U);
  EXPECT_EQ(recorder.bus().counters().overslept, 4U * 9U);
  std::size_t afterwards = 0;
  for (int i = 0; i < 16; ++i) afterwards += recorder.step(250us);
  EXPECT_EQ(afterwards, 4U * 4U);
}

TEST(SimBus, DrivesOfOneBusNeedNotSpeakTogether) {
  SimBusConfig config = mixedBus();
  config.phase_spread = 250us;
  ASSERT_TRUE(SimBus::check(config));
  Recorder recorder{config};
  std::size_t most = 0;
  for (int i = 0; i < 100; ++i) most = std::max(most, recorder.step(20us));
  EXPECT_LT(most, 4U);
  for (int i = 0; i < 49'900; ++i) recorder.step(20us);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(static_cast<double>(recorder.heard(i)), 1000.0, 1.0);
}

TEST(SimBus, LosesTheFractionOfFramesThatItIsTold) {
  Recorder recorder{mixedBus()};
  recorder.bus().loseFrames(1, 0.3F);
  recorder.drive(20s);
  EXPECT_EQ(recorder.heard(0), 20'000U);
  EXPECT_NEAR(static_cast<double>(recorder.heard(1)), 14'000.0, 300.0);
  EXPECT_EQ(recorder.bus().counters().lost, 20'000U - recorder.heard(1));
  recorder.bus().loseFrames(1, 1.0F);
  const auto before = recorder.heard(1);
  recorder.drive(100ms);
  EXPECT_EQ(recorder.heard(1), before);
}

TEST(SimBus, ASilentDriveSaysNothingAndStillObeys) {
  Recorder recorder{mixedBus()};
  const auto yaw = recorder.bus().indexOf("yaw");
  ASSERT_EQ(yaw, 2U);
  recorder.bus().silence(*yaw, true);
  recorder.drive(300ms);
  EXPECT_EQ(recorder.heard(*yaw), 0U);
  EXPECT_GT(std::abs(recorder.bus().motor(*yaw).outputRpm()), 1.0);
  recorder.bus().silence(*yaw, false);
  recorder.drive(100ms);
  EXPECT_EQ(recorder.heard(*yaw), 100U);
}

TEST(SimBus, AStalledShaftStopsAtOnceAndTurnsAgainAfterwards) {
  Recorder recorder{mixedBus()};
  recorder.drive(300ms);
  ASSERT_GT(recorder.bus().motor(0).outputRpm(), 10.0);
  recorder.bus().stall(0, true);
  recorder.step();
  const double held_deg = recorder.bus().motor(0).outputAngleDeg();
  recorder.drive(300ms);
  EXPECT_EQ(recorder.bus().motor(0).outputAngleDeg(), held_deg);
  EXPECT_GT(recorder.bus().motor(0).currentA(), 1.0);
  recorder.bus().stall(0, false);
  recorder.drive(300ms);
  EXPECT_GT(recorder.bus().motor(0).outputAngleDeg(), held_deg + 1.0);
}

TEST(SimBus, AnotherLoadTakesEffectWithoutAJump) {
  Recorder recorder{mixedBus()};
  recorder.drive(300ms);
  const double deg = recorder.bus().motor(0).outputAngleDeg();
  const double rpm = recorder.bus().motor(0).outputRpm();
  MotorLoad load;
  load.load_torque_nm = 2.0F;
  load.initial_angle_deg = 77.0F;
  recorder.bus().setLoad(0, load);
  EXPECT_EQ(recorder.bus().motor(0).outputAngleDeg(), deg);
  EXPECT_EQ(recorder.bus().motor(0).outputRpm(), rpm);
  recorder.bus().receive(makeClassicFrame({0x200, false}, std::array<std::uint8_t, 8>{}));
  for (int i = 0; i < 1000; ++i) recorder.step();
  EXPECT_LT(recorder.bus().motor(0).outputRpm(), -10.0);
}

TEST(SimBus, TemperatureCanBeSetForATest) {
  Recorder recorder{mixedBus()};
  recorder.bus().setTemperature(0, 110.0);
  EXPECT_EQ(dynamic_cast<DjiDrive&>(recorder.bus().drive(0)).feedbackFrame().data[6], 110);
}

TEST(SimBus, AFaultOfOneDriveThatPassesLeavesTheOthersAsTheyWere) {
  Recorder plain{mixedBus(3, 0.2F)};
  Recorder troubled{mixedBus(3, 0.2F)};
  plain.drive(2s);
  troubled.drive(2s, [&](int ms) { troubled.bus().silence(0, ms >= 500 && ms < 1000); });
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(plain.heard(i), troubled.heard(i));
  EXPECT_LT(troubled.heard(0), plain.heard(0));
}

TEST(SimBus, FramesThatDoNotFitAreCounted) {
  SimBus bus{mixedBus()};
  std::array<CanFrame, 3> out;
  EXPECT_EQ(bus.step(MonotonicTime{1ms}, 1ms, out), 3U);
  EXPECT_EQ(bus.counters().overflowed, 1U);
}

TEST(SimBus, TimeThatDoesNotAdvanceChangesNothing) {
  Recorder recorder{mixedBus()};
  recorder.drive(300ms);
  const double deg = recorder.bus().motor(0).outputAngleDeg();
  EXPECT_EQ(recorder.step(0ms), 0U);
  EXPECT_EQ(recorder.step(-5ms), 0U);
  EXPECT_EQ(recorder.bus().motor(0).outputAngleDeg(), deg);
}

TEST(SimBus, SteppingAllocatesNothing) {
  Recorder recorder{mixedBus(1, 0.1F)};
  AllocGuard guard;
  recorder.drive(100ms);
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST(SimBus, CheckRefusesTwoDrivesWithOneFeedbackIdAndNamesBoth) {
  SimBusConfig config;
  config.drives = {djiDrive({"wheel", &kM3508, 5, DjiCommand::kCurrent, 0.0, {}}),
                   djiDrive({"yaw", &kGM6020, 1, DjiCommand::kCurrent, 0.0, {}})};
  const auto refused = SimBus::check(config);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("'wheel'"), std::string::npos);
  EXPECT_NE(refused.error().message.find("'yaw'"), std::string::npos);
  config.drives[1] = djiDrive({"yaw", &kGM6020, 5, DjiCommand::kCurrent, 0.0, {}});
  EXPECT_TRUE(SimBus::check(config));
  config.drives[1] = djiDrive({"wheel", &kGM6020, 5, DjiCommand::kCurrent, 0.0, {}});
  EXPECT_FALSE(SimBus::check(config));
  EXPECT_TRUE(SimBus::check(mixedBus()));
  EXPECT_FALSE(SimBus{mixedBus()}.indexOf("nobody"));
}

}  // namespace
}  // namespace rc10::test::sim_bus_test
