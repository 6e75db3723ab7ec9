#include "daemon/exchange/estop_contact.hpp"

#include <gtest/gtest.h>

namespace rc10::test::estop_contact_test {
namespace {

using enum ContactState;

class EstopContactTest : public ::testing::Test {
 protected:
  EstopContact::View look() { return contact.look(0.001F); }

  EstopContact contact;
};

TEST_F(EstopContactTest, WithoutAnInputNothingEverStops) {
  for (int i = 0; i < 10'000; ++i) {
    const auto view = look();
    ASSERT_FALSE(view.stop);
    ASSERT_FALSE(view.news);
  }
  EXPECT_FALSE(contact.open());
}

TEST_F(EstopContactTest, AClosedContactIsNoNews) {
  contact.show(kClosed);
  const auto view = look();
  EXPECT_FALSE(view.stop);
  EXPECT_FALSE(view.news);
}

TEST_F(EstopContactTest, OpenAndUnreadableStopForAsLongAsTheyLast) {
  for (const auto state : {kOpen, kUnreadable}) {
    contact.show(state);
    const auto first = look();
    EXPECT_TRUE(first.stop);
    EXPECT_EQ(first.news, state);
    contact.show(state);
    const auto second = look();
    EXPECT_TRUE(second.stop);
    EXPECT_FALSE(second.news);  // told once
    EXPECT_TRUE(contact.open());
  }
  contact.show(kClosed);
  const auto view = look();
  EXPECT_FALSE(view.stop);
  EXPECT_EQ(view.news, kClosed);
  EXPECT_FALSE(contact.open());
}

TEST_F(EstopContactTest, AnOpeningBetweenTwoTicksIsNotMissed) {
  contact.show(kClosed);
  (void)look();
  contact.show(kOpen);
  contact.show(kClosed);
  const auto view = look();
  EXPECT_TRUE(view.stop);
  EXPECT_EQ(view.news, kOpen);
  EXPECT_FALSE(contact.open());  // `clear` need not wait
  const auto after = look();
  EXPECT_FALSE(after.stop);
  EXPECT_EQ(after.news, kClosed);
}

TEST_F(EstopContactTest, AWatcherThatIsSilentCountsAsUnreadable) {
  contact.show(kClosed);
  for (int i = 0; i < 150; ++i) ASSERT_FALSE(look().stop) << i;
  contact.show(kClosed);
  for (int i = 0; i < 190; ++i) ASSERT_FALSE(look().stop) << i;
  std::optional<ContactState> news;
  for (int i = 0; i < 30; ++i) {
    const auto view = look();
    if (view.news) news = view.news;
  }
  EXPECT_EQ(news, kUnreadable);
  EXPECT_TRUE(look().stop);
  EXPECT_TRUE(contact.open());
  contact.show(kClosed);
  EXPECT_EQ(look().news, kClosed);
}

}  // namespace
}  // namespace rc10::test::estop_contact_test
