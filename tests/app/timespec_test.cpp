#include "app/timespec.hpp"

#include <gtest/gtest.h>

namespace rc10::test::timespec_test {
namespace {

using namespace std::chrono_literals;

TEST(Timespec, SecondsAndTheRestOfThem) {
  constexpr timespec kTime = toTimespec(3s + 7ns);
  EXPECT_EQ(kTime.tv_sec, 3);
  EXPECT_EQ(kTime.tv_nsec, 7);
  EXPECT_EQ(toTimespec(999'999'999ns).tv_sec, 0);
  EXPECT_EQ(toTimespec(1s).tv_nsec, 0);
}

}  // namespace
}  // namespace rc10::test::timespec_test
