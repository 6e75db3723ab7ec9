#include "app/subnormals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

#include "app/low_pass.hpp"

namespace rc10::test::subnormals_test {
namespace {

// Result of this thread, at run time.
float halfOfTheSmallest() {
  volatile float smallest = std::numeric_limits<float>::min();
  return smallest * 0.5F;
}

TEST(Subnormals, AreZeroInTheThreadThatFlushesThemOnly) {
  float flushed = 1.0F;
  std::thread([&] {
    flushSubnormals();
    flushed = halfOfTheSmallest();
  }).join();
  EXPECT_EQ(flushed, 0.0F);
  EXPECT_GT(halfOfTheSmallest(), 0.0F);
}

TEST(Subnormals, AreZeroAsOperandsToo) {
  volatile float subnormal = halfOfTheSmallest();
  float sum = 1.0F;
  std::thread([&] {
    flushSubnormals();
    sum = subnormal * 1e10F;
  }).join();
  EXPECT_EQ(sum, 0.0F);
  EXPECT_GT(subnormal, 0.0F);
}

TEST(Subnormals, AreWhatAFilterThatFadesOutEndsIn) {
  const auto after_a_minute = [] {
    volatile float input = 1.0F;
    LowPass filter(20.0F);
    filter.step(input, 0.001F);
    input = 0.0F;
    for (int i = 0; i < 60'000; ++i) filter.step(input, 0.001F);
    return filter.value();
  };
  float flushed = 0.0F;
  std::thread([&] {
    flushSubnormals();
    flushed = after_a_minute();
  }).join();
  EXPECT_EQ(std::fpclassify(after_a_minute()), FP_SUBNORMAL);
  EXPECT_NE(std::fpclassify(flushed), FP_SUBNORMAL) << flushed;
}

}  // namespace
}  // namespace rc10::test::subnormals_test
