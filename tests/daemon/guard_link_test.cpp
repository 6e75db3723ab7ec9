// Without a guard; with one: tests/kernel/test_guard.py.
#include "daemon/guard_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace rc10::test::guard_link_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StrEq;

class GuardLinkTest : public testing::Test {
 protected:
  GuardLinkTest() {
    if (::mkdtemp(dir.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  }
  ~GuardLinkTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(dir, ignored);
  }
  [[nodiscard]] Result<std::unique_ptr<GuardLink>> with(const std::string& program) const {
    return GuardLink::create({.run_dir = dir,
                              .program = program,
                              .hello = {.robot = "hero", .standstill_ms = 20, .rest_frames = ""}});
  }

  std::string dir = "/tmp/rc10-test-XXXXXX";
};

TEST_F(GuardLinkTest, AGuardThatEndsAtOnceIsNotWaitedForForEver) {
  const auto link = with("/bin/false");
  ASSERT_FALSE(link);
  EXPECT_THAT(link.error().message,
              StrEq("/bin/false was started and does not answer at " + dir + "/guard.socket"));
}

TEST_F(GuardLinkTest, AGuardThatIsNotInstalledIsNamed) {
  const auto link = with(dir + "/rc10-guard");
  ASSERT_FALSE(link);
  EXPECT_THAT(link.error().message, HasSubstr(dir + "/rc10-guard could not be started: No such file"));
}

}  // namespace
}  // namespace rc10::test::guard_link_test
