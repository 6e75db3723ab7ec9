#include "app/preempt_rt.hpp"

#include <gtest/gtest.h>

namespace rc10::test::preempt_rt_test {
namespace {

constexpr std::string_view kOrdinary = "#1 SMP PREEMPT_DYNAMIC Debian 6.1.147-1 (2025-08-02)\n";
constexpr std::string_view kMainline = "#1 SMP PREEMPT_RT Debian 6.12.48-1 (2025-09-20)\n";

TEST(PreemptRt, AnOrdinaryKernelIsNone) {
  EXPECT_FALSE(isPreemptRt("", kOrdinary));
  EXPECT_FALSE(isPreemptRt("0\n", kOrdinary));
  EXPECT_FALSE(isPreemptRt("", ""));
}

TEST(PreemptRt, IsTheOneOfThePatchAndThatOfMainline) {
  EXPECT_TRUE(isPreemptRt("1\n", kOrdinary));
  EXPECT_TRUE(isPreemptRt("", kMainline));
}

}  // namespace
}  // namespace rc10::test::preempt_rt_test
