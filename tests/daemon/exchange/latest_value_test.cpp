#include "daemon/exchange/latest_value.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace rc10::latest_value_test {
namespace {

TEST(LatestValue, ReadsTheNewestOfSeveralValues) {
  LatestValue<int> box;
  for (const int value : {1, 2, 3}) {
    box.slot() = value;
    box.publish();
  }
  EXPECT_EQ(box.read(), 3);
  EXPECT_EQ(box.read(), 3);
}

TEST(LatestValue, DoesNotShowAValueThatIsNotPublished) {
  LatestValue<int> box;
  box.slot() = 1;
  box.publish();
  box.slot() = 2;
  EXPECT_EQ(box.read(), 1);
}

TEST(LatestValue, KnowsWhetherThereWasEverAValue) {
  LatestValue<int> box;
  EXPECT_FALSE(box.everPublished());
  box.publish();
  EXPECT_TRUE(box.everPublished());
  (void)box.read();
  EXPECT_TRUE(box.everPublished());
}

// Every word of a value is its number: a torn read would mix two.
TEST(LatestValue, IsNeverTornAndNeverGoesBack) {
  using Value = std::array<std::uint64_t, 64>;
  LatestValue<Value> box;
  constexpr std::uint64_t kValues = 200'000;
  std::thread writer([&box] {
    for (std::uint64_t i = 1; i <= kValues; ++i) {
      box.slot().fill(i);
      box.publish();
    }
  });
  std::uint64_t last = 0;
  while (last < kValues) {
    const Value& value = box.read();
    for (const auto word : value) ASSERT_EQ(word, value.front());
    ASSERT_GE(value.front(), last);
    last = value.front();
  }
  writer.join();
}

}  // namespace
}  // namespace rc10::latest_value_test
