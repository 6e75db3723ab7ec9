#include "robot_file/program_run.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>

namespace rc10::robot_file::test::program_run_test {
namespace {

TEST(ProgramRun, GivesTheTextAndTakesBothOutputs) {
  const auto end = runProgram({"/bin/sh", "-c", "cat /proc/self/fd/0; echo mistake >&2; exit 2"}, "text\n");
  ASSERT_TRUE(end);
  EXPECT_EQ(end->status, 2);
  EXPECT_EQ(end->output, "text\nmistake\n");
}

TEST(ProgramRun, AProgramThatIsNotThereIsNotStarted) {
  EXPECT_EQ(runProgram({"/nowhere/program"}).value().status, ProgramEnd::kNotStarted);
}

TEST(ProgramRun, ASignalIsTold) {
  EXPECT_EQ(runProgram({"/bin/sh", "-c", "kill -KILL $$"}).value().status, 128 + SIGKILL);
}

TEST(ProgramRun, AnEndlessOutputIsReadToItsEndAndCut) {
  const auto end = runProgram({"/bin/sh", "-c", "head -c 1000000 /dev/zero"});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->status, 0);
  EXPECT_LE(end->output.size(), 40'000U);
}

TEST(ProgramRun, NothingOfTheEnvironmentGoesAlong) {
  ASSERT_EQ(::setenv("RC10_RUN_DIR", "/tmp/elsewhere", 1), 0);
  EXPECT_EQ(runProgram({"/bin/sh", "-c", "echo \"'$RC10_RUN_DIR'\""}).value().output, "''\n");
  ::unsetenv("RC10_RUN_DIR");
}

TEST(ProgramRun, ALesserUserMayWriteNoFile) {
  const LesserUser own{.user = ::geteuid(), .group = ::getegid()};
  const auto end = runProgram({"/bin/sh", "-c", "echo text >/tmp/rc10-must-not-be && echo written"}, {}, own);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->output.find("written"), std::string::npos) << end->output;
  ::unlink("/tmp/rc10-must-not-be");
}

}  // namespace
}  // namespace rc10::robot_file::test::program_run_test
