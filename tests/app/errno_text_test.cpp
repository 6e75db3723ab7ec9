#include "app/errno_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

namespace rc10::test::errno_text_test {
namespace {

using ::testing::EndsWith;
using ::testing::StrEq;

TEST(ErrnoText, IsThatOfTheSystem) { EXPECT_THAT(errnoText(ENOENT), StrEq("No such file or directory")); }

TEST(ErrnoText, OutOfDescriptorsComesWithTheRemedy) {
  EXPECT_THAT(errnoText(EMFILE), EndsWith("files; raise the limit (LimitNOFILE= of the unit, `ulimit -n`)"));
  EXPECT_THAT(errnoText(ENFILE),
              EndsWith("in system; raise the limit of the whole computer (`sysctl fs.file-max`)"));
}

}  // namespace
}  // namespace rc10::test::errno_text_test
