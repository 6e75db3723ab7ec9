#include "daemon/child_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

namespace rc10::test::child_process_test {
namespace {

using ::testing::HasSubstr;

TEST(SiblingProgram, LiesBesideOurOwnExecutable) {
  const auto self = std::filesystem::read_symlink("/proc/self/exe");
  EXPECT_EQ(siblingProgram("rc10-lcm"), (self.parent_path() / "rc10-lcm").string());
}

TEST(StartChild, InASessionOfItsOwnItLeadsOne) {
  const auto child = startChild("/bin/sleep", {"1000"}, {.own_session = true});
  ASSERT_TRUE(child);
  EXPECT_EQ(::getsid(*child), *child);
  EXPECT_EQ(::kill(*child, SIGKILL), 0);
  EXPECT_EQ(::waitpid(*child, nullptr, 0), *child);
}

TEST(StartChild, OtherwiseItSharesOurs) {
  const auto child = startChild("/bin/sleep", {"1000"});
  ASSERT_TRUE(child);
  EXPECT_EQ(::getsid(*child), ::getsid(0));
  EXPECT_EQ(::kill(*child, SIGKILL), 0);
  EXPECT_EQ(::waitpid(*child, nullptr, 0), *child);
}

TEST(StartChild, AProgramThatIsNotThereIsNamed) {
  const auto child = startChild("/no/such/program", {});
  ASSERT_FALSE(child);
  EXPECT_THAT(child.error().message, HasSubstr("/no/such/program could not be started: No such file"));
}

}  // namespace
}  // namespace rc10::test::child_process_test
