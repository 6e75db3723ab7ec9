#include "web/page_link.hpp"

#include <fcntl.h>
#include <sys/socket.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/unique_fd.hpp"
#include "client/fake_rc10d.hpp"

namespace rc10::web::test::page_link_test {
namespace {

/// Connections that wait at a socket.
int waiting(const UniqueFd& listener) {
  int count = 0;
  while (UniqueFd{::accept4(listener.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)}) ++count;
  return count;
}

TEST(PageLink, AnRc10dThatDoesNotAnswerIsNotAskedInARow) {
  rc10::test::TemporaryRunDir dir;
  const auto listener = dir.listen("hero");
  ASSERT_EQ(::fcntl(listener.get(), F_SETFL, O_NONBLOCK), 0);
  PageLink link("web-1");
  const auto why = link.connect(dir.path() + "/hero.sock");
  EXPECT_THAT(why, ::testing::HasSubstr("does not answer"));
  EXPECT_EQ(link.connect(dir.path() + "/hero.sock"), why);
  EXPECT_EQ(waiting(listener), 1) << "the second time nobody was asked, and nobody waited";
  // Another token may be heard where this one was not.
  link.showToken("another");
  EXPECT_EQ(link.connect(dir.path() + "/hero.sock"), why);
  EXPECT_EQ(waiting(listener), 1);
}

}  // namespace
}  // namespace rc10::web::test::page_link_test
