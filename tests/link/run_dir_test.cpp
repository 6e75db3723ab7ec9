#include "link/run_dir.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

namespace rc10::link::test::run_dir_test {
namespace {

class RunDir : public testing::Test {
 protected:
  RunDir() {
    if (const char* dir = std::getenv("RC10_RUN_DIR")) before_ = dir;
  }
  ~RunDir() override { ::setenv("RC10_RUN_DIR", before_.c_str(), 1); }

 private:
  std::string before_;
};

TEST_F(RunDir, IsTheEnvironmentsChoice) {
  ::setenv("RC10_RUN_DIR", "/somewhere", 1);
  EXPECT_EQ(runDir(), "/somewhere");
  EXPECT_EQ(socketPath("hero"), "/somewhere/hero.sock");
}

TEST_F(RunDir, IsTheSystemsWithoutOne) {
  ::unsetenv("RC10_RUN_DIR");
  EXPECT_EQ(runDir(), "/run/rc10d");
  ::setenv("RC10_RUN_DIR", "", 1);
  EXPECT_EQ(socketPath("hero"), "/run/rc10d/hero.sock");
}

}  // namespace
}  // namespace rc10::link::test::run_dir_test
