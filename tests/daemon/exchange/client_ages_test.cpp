#include "daemon/exchange/client_ages.hpp"

#include <gtest/gtest.h>

#include <string>

namespace rc10::test::client_ages_test {
namespace {

using namespace std::chrono_literals;

TEST(ClientAges, EachClientHasAHistogramOfItsOwn) {
  ClientAges ages;
  ages.record(link::Name{"teleop"}, 2ms);
  ages.record(link::Name{"planner"}, 5ms);
  ages.record(link::Name{"teleop"}, 3ms);
  ASSERT_EQ(ages.count(), 2U);
  EXPECT_EQ(ages.name(0).view(), "teleop");
  EXPECT_EQ(ages.of(0).count(), 2U);
  EXPECT_EQ(ages.of(0).max(), 3ms);
  EXPECT_EQ(ages.name(1).view(), "planner");
  EXPECT_EQ(ages.of(1).max(), 5ms);
  EXPECT_EQ(ages.ofOthers().count(), 0U);
}

TEST(ClientAges, FurtherClientsShareOneAndTheFirstKeepTheirs) {
  ClientAges ages;
  for (std::size_t i = 0; i < ClientAges::kNamed + 3; ++i)
    ages.record(link::Name{"client" + std::to_string(i)}, 1ms);
  ages.record(link::Name{"client0"}, 7ms);
  EXPECT_EQ(ages.count(), ClientAges::kNamed);
  EXPECT_EQ(ages.of(0).count(), 2U);
  EXPECT_EQ(ages.ofOthers().count(), 3U);
}

}  // namespace
}  // namespace rc10::test::client_ages_test
