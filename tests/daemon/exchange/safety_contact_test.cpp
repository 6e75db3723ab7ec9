#include "daemon/exchange/safety_contact.hpp"

#include <gtest/gtest.h>

namespace rc10::test::safety_contact_test {
namespace {

using enum ContactState;

class SafetyContactTest : public ::testing::Test {
 protected:
  SafetyContact::View look() { return contact.look(0.001F); }

  SafetyContact contact;
};

TEST_F(SafetyContactTest, WithoutAnInputNothingEverStops) {
  for (int i = 0; i < 10'000; ++i) {
    const auto view = look();
    ASSERT_FALSE(view.opened);
    ASSERT_FALSE(view.news);
  }
  EXPECT_FALSE(contact.open());
}

TEST_F(SafetyContactTest, AClosedContactIsNoNews) {
  contact.show(kClosed);
  const auto view = look();
  EXPECT_FALSE(view.opened);
  EXPECT_FALSE(view.news);
}

TEST_F(SafetyContactTest, OpenAndUnreadableStopForAsLongAsTheyLast) {
  for (const auto state : {kOpen, kUnreadable}) {
    contact.show(state);
    const auto first = look();
    EXPECT_TRUE(first.opened);
    EXPECT_EQ(first.news, state);
    contact.show(state);
    const auto second = look();
    EXPECT_TRUE(second.opened);
    EXPECT_FALSE(second.news);  // told once
    EXPECT_TRUE(contact.open());
  }
  contact.show(kClosed);
  const auto view = look();
  EXPECT_FALSE(view.opened);
  EXPECT_EQ(view.news, kClosed);
  EXPECT_FALSE(contact.open());
}

TEST_F(SafetyContactTest, AnOpeningBetweenTwoTicksIsNotMissed) {
  contact.show(kClosed);
  (void)look();
  contact.show(kOpen);
  contact.show(kClosed);
  const auto view = look();
  EXPECT_TRUE(view.opened);
  EXPECT_EQ(view.news, kOpen);
  EXPECT_FALSE(contact.open());  // `clear` need not wait
  const auto after = look();
  EXPECT_FALSE(after.opened);
  EXPECT_EQ(after.news, kClosed);
}

TEST_F(SafetyContactTest, AWatcherThatIsSilentCountsAsUnreadable) {
  contact.show(kClosed);
  for (int i = 0; i < 150; ++i) ASSERT_FALSE(look().opened) << i;
  contact.show(kClosed);
  for (int i = 0; i < 190; ++i) ASSERT_FALSE(look().opened) << i;
  std::optional<ContactState> news;
  for (int i = 0; i < 30; ++i) {
    const auto view = look();
    if (view.news) news = view.news;
  }
  EXPECT_EQ(news, kUnreadable);
  EXPECT_TRUE(look().opened);
  EXPECT_TRUE(contact.open());
  contact.show(kClosed);
  EXPECT_EQ(look().news, kClosed);
}

}  // namespace
}  // namespace rc10::test::safety_contact_test
