#include "app/account_ids.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "daemon/temp_dir.hpp"

namespace rc10::test::account_ids_test {
namespace {

TEST(AccountIds, AreThoseOfTheFiles) {
  const TempDir etc;
  std::ofstream(etc / "passwd") << "root:x:0:0::/root:/bin/sh\nanna:x:1234:100::/home/anna:/bin/sh\n";
  std::ofstream(etc / "group") << "root:x:0:\nrc10:x:998:anna\n";
  EXPECT_EQ(userId("anna", etc.path()), 1234U);
  EXPECT_EQ(userId("rc10", etc.path()), std::nullopt) << "a group";
  EXPECT_EQ(groupId("rc10", etc.path()), 998U);
  EXPECT_EQ(groupId("ann", etc.path()), std::nullopt);
}

TEST(AccountIds, OfAFolderWithoutTheFilesAreUnknown) {
  EXPECT_EQ(userId("root", "/nowhere"), std::nullopt);
  EXPECT_EQ(groupId("root", "/nowhere"), std::nullopt);
}

}  // namespace
}  // namespace rc10::test::account_ids_test
