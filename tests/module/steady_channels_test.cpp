#include "module/steady_channels.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace rc10::test::steady_channels_test {
namespace {

constexpr double kTolerance = 0.05;

/// A stick and a key.
class SteadyChannelsTest : public ::testing::Test {
 protected:
  void take(double stick, double key) { channels_.take(std::array{stick, key}); }
  double stick() const { return channels_[0]; }
  double key() const { return channels_[1]; }

  SteadyChannels channels_{{kTolerance, 0.0}};
};

TEST_F(SteadyChannelsTest, HaveNoValueBeforeTwoFramesAgree) {
  take(0.5, 1.0);
  EXPECT_TRUE(std::isnan(stick()));
  EXPECT_FALSE(channels_.heard());
  take(0.9, 1.0);
  EXPECT_TRUE(std::isnan(stick()));
  EXPECT_EQ(key(), 1.0);
  EXPECT_TRUE(channels_.heard());
  EXPECT_FALSE(channels_.settled());
  take(0.9, 0.0);
  EXPECT_EQ(stick(), 0.9);
  EXPECT_EQ(key(), 1.0);
  EXPECT_TRUE(channels_.settled());
}

TEST_F(SteadyChannelsTest, BeginAnewAfterARestart) {
  for (int i = 0; i < 3; ++i) take(0.0, 0.0);
  channels_.restart();
  take(1.0, 1.0);
  EXPECT_FALSE(channels_.heard());
  EXPECT_FALSE(channels_.settled());
  take(1.0, 1.0);
  EXPECT_EQ(stick(), 1.0);
  EXPECT_EQ(key(), 1.0);
}

TEST_F(SteadyChannelsTest, FollowAStickWithoutDelayAsLongAsItIsMovedByHand) {
  for (int i = 0; i < 3; ++i) take(0.0, 0.0);
  for (const double step : {kTolerance, -kTolerance}) {
    for (double deflection = stick(), i = 0; i < 20; ++i) {
      deflection += step;
      take(deflection, 0.0);
      EXPECT_NEAR(stick(), deflection, 1e-9);
    }
  }
}

TEST_F(SteadyChannelsTest, FollowAStickThatJumpsAFrameLater) {
  for (int i = 0; i < 3; ++i) take(1.0, 0.0);
  take(0.0, 0.0);
  EXPECT_NEAR(stick(), 1.0 - kTolerance, 1e-9);
  take(0.0, 0.0);
  EXPECT_EQ(stick(), 0.0);
}

TEST_F(SteadyChannelsTest, BelieveNoFrameThatStandsAlone) {
  for (int i = 0; i < 3; ++i) take(0.0, 0.0);
  for (const double value : {1.0, 0.0, -1.0, 0.0}) {
    take(value, value);
    EXPECT_LE(std::fabs(stick()), kTolerance);
    EXPECT_EQ(key(), 0.0);
  }
  take(0.0, 1.0);
  take(0.0, 0.0);
  take(0.0, 1.0);
  EXPECT_EQ(key(), 0.0) << "no two in a row";
  take(0.0, 1.0);
  EXPECT_EQ(key(), 1.0);
}

}  // namespace
}  // namespace rc10::test::steady_channels_test
