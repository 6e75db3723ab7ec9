#include "app/whole_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "daemon/temp_dir.hpp"

namespace rc10::test::whole_file_test {
namespace {

TEST(WholeFile, IsReadToItsEnd) {
  const TempDir folder;
  const std::string text(10'000, 'x');
  std::ofstream(folder / "file") << text;
  EXPECT_EQ(readWholeFile(folder / "file"), text);
  EXPECT_EQ(readWholeFile("/dev/null"), "");
}

TEST(WholeFile, OneThatOpensAndCannotBeReadIsNoCrash) {
  EXPECT_EQ(readWholeFile("/proc/self/mem"), std::nullopt) << "as that of a process that has ended";
  EXPECT_EQ(readWholeFile("/tmp"), std::nullopt);
  EXPECT_EQ(readWholeFile("/nowhere"), std::nullopt);
}

}  // namespace
}  // namespace rc10::test::whole_file_test
