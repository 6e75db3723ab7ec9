#include "web/renewal_age.hpp"

#include <gtest/gtest.h>

namespace rc10::web::test::renewal_age_test {
namespace {

using namespace std::chrono_literals;

/// A page whose clock began 100 s after the server's.
MonotonicTime arrival(Duration sent, Duration way) { return MonotonicTime{100s + sent + way}; }

TEST(RenewalAge, CountsFromTheQuickestMessage) {
  RenewalAge ages;
  EXPECT_EQ(ages.ageOf(0ms, arrival(0ms, 7ms)), 0ms);
  EXPECT_EQ(ages.ageOf(50ms, arrival(50ms, 3ms)), 0ms) << "a quicker one";
  EXPECT_NEAR(std::chrono::duration<double>(ages.ageOf(100ms, arrival(100ms, 43ms))).count(), 0.040, 0.001);
}

TEST(RenewalAge, ABurstThatWasHeldUpIsAsOldAsItIs) {
  RenewalAge ages;
  (void)ages.ageOf(0ms, arrival(0ms, 2ms));
  // Twenty messages, 50 ms apart, arrive together a second later.
  for (int i = 1; i <= 20; ++i) {
    const auto sent = 50ms * i;
    const auto age = ages.ageOf(sent, MonotonicTime{100s + 1002ms});
    EXPECT_NEAR(std::chrono::duration<double>(age).count(), 1.0 - 0.05 * i, 0.002) << i;
  }
}

TEST(RenewalAge, TwoClocksThatDriftApartDoNotMakeAPageOld) {
  RenewalAge ages;
  // 200 ppm for an hour are 0.72 s.
  for (int i = 0; i < 72'000; ++i) {
    const auto sent = 50ms * i;
    const auto age = ages.ageOf(sent, arrival(sent, 2ms + sent / 5000));
    ASSERT_LT(age, 1ms) << i;
  }
}

}  // namespace
}  // namespace rc10::web::test::renewal_age_test
