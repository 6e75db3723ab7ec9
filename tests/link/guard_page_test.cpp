#include "link/guard_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "link/descriptor_message.hpp"

namespace rc10::link::test::guard_page_test {
namespace {

using ::testing::HasSubstr;

TEST(SharedGuardPage, TwoMappingsAreOnePage) {
  const auto ours = SharedGuardPage::create();
  ASSERT_TRUE(ours);
  const auto theirs = SharedGuardPage::map(UniqueFd{::dup(ours->descriptor())});
  ASSERT_TRUE(theirs);
  (*ours)->ticks.store(42);
  (*theirs)->acted.store(true);
  EXPECT_EQ((*theirs)->ticks.load(), 42U);
  EXPECT_TRUE((*ours)->acted.load());
}

TEST(SharedGuardPage, CannotBeCutOffBehindTheBackOfItsReader) {
  const auto page = SharedGuardPage::create();
  ASSERT_TRUE(page);
  EXPECT_NE(::ftruncate(page->descriptor(), 0), 0);
}

TEST(SharedGuardPage, MemoryThatCouldBeCutOffIsRefused) {
  UniqueFd unsealed{::memfd_create("test", MFD_CLOEXEC)};
  ASSERT_EQ(::ftruncate(unsealed.get(), 4096), 0);
  const auto page = SharedGuardPage::map(std::move(unsealed));
  ASSERT_FALSE(page);
  EXPECT_THAT(page.error().message, HasSubstr("no sealed page"));
  EXPECT_FALSE(SharedGuardPage::map(UniqueFd{}));
}

class DescriptorMessageTest : public testing::Test {
 protected:
  DescriptorMessageTest() {
    std::array<int, 2> pair{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, pair.data()), 0);
    a = UniqueFd{pair[0]};
    b = UniqueFd{pair[1]};
  }
  UniqueFd a;
  UniqueFd b;
};

TEST_F(DescriptorMessageTest, CarriesTextAndDescriptorsTogether) {
  const auto page = SharedGuardPage::create();
  const std::array sent{page->descriptor(), page->descriptor()};
  ASSERT_TRUE(sendWithDescriptors(a.get(), "hello", sent));
  DescriptorMessage message;
  ASSERT_TRUE(receiveWithDescriptors(b.get(), message));
  EXPECT_EQ(message.text, "hello");
  ASSERT_EQ(message.descriptors.size(), 2U);
  (*page)->ticks.store(3);
  const auto theirs = SharedGuardPage::map(std::move(message.descriptors[1]));
  ASSERT_TRUE(theirs);
  EXPECT_EQ((*theirs)->ticks.load(), 3U);
}

TEST_F(DescriptorMessageTest, NothingAndTheEndAreToldApart) {
  DescriptorMessage message;
  EXPECT_FALSE(receiveWithDescriptors(b.get(), message));
  EXPECT_EQ(errno, EAGAIN);
  a.reset();
  EXPECT_FALSE(receiveWithDescriptors(b.get(), message));
  EXPECT_EQ(errno, 0);
}

TEST_F(DescriptorMessageTest, MoreDescriptorsThanAMessageMayHaveAreNotKept) {
  std::array<int, DescriptorMessage::kMaxDescriptors + 1> many{};
  many.fill(a.get());
  EXPECT_FALSE(sendWithDescriptors(a.get(), "many", many));
  EXPECT_EQ(errno, EMSGSIZE);
}

}  // namespace
}  // namespace rc10::link::test::guard_page_test
