#include "module/silence.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "module/fake_robot.hpp"

namespace rc10::test::silence_test {
namespace {

constexpr std::size_t kSilent = 4;
constexpr std::size_t kBack = 7;

std::vector<std::size_t> reportedOf(const std::vector<bool>& freshness) {
  FakeRobot robot(0);
  Silence silence{kSilent, kBack};
  for (const bool fresh : freshness) silence.watch(fresh, robot);
  return robot.events();
}

TEST(Silence, ASourceThatFallsSilentIsReportedOnceAndOnceWhenItIsBack) {
  EXPECT_THAT(reportedOf({true, false, false, false, true, true}), ::testing::ElementsAre(kSilent, kBack));
}

TEST(Silence, ASourceThatWasNeverHeardIsNotReported) {
  EXPECT_THAT(reportedOf({false, false, true, true}), ::testing::IsEmpty());
}

TEST(Silence, EachSilenceIsReported) {
  EXPECT_THAT(reportedOf({true, false, true, false}), ::testing::ElementsAre(kSilent, kBack, kSilent));
}

}  // namespace
}  // namespace rc10::test::silence_test
