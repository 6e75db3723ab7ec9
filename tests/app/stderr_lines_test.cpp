#include "app/stderr_lines.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/socket.h>
#include <termios.h>

#include <array>
#include <csignal>

namespace rc10::test::stderr_lines_test {
namespace {

struct Ends {
  UniqueFd read;
  UniqueFd write;
};

Ends pipeEnds() {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
  return {.read = UniqueFd{ends[0]}, .write = UniqueFd{ends[1]}};
}

std::string readFrom(const UniqueFd& end) {
  std::array<char, 256> text{};
  const auto size = ::read(end.get(), text.data(), text.size());
  return {text.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

// A writer that waited would not return from the last of them.
int linesUntilOneIsLost(const StderrLines& lines) {
  constexpr int kFarMoreThanFit = 100'000;
  int told = 0;
  while (told < kFarMoreThanFit && lines.tell(std::string(100, 'x'))) ++told;
  EXPECT_LT(told, kFarMoreThanFit);
  return told;
}

TEST(StderrLines, ALineOnAPipeIsWhole) {
  const auto [read, write] = pipeEnds();
  EXPECT_TRUE(StderrLines{write.get()}.tell("told"));
  EXPECT_EQ(readFrom(read), "told\n");
}

TEST(StderrLines, AFullPipeLosesLinesUntilItIsRead) {
  const auto [read, write] = pipeEnds();
  const StderrLines lines{write.get()};
  EXPECT_GT(linesUntilOneIsLost(lines), 0);
  for (int i = 0; i < 64; ++i) readFrom(read);
  EXPECT_TRUE(lines.tell("told again"));
}

TEST(StderrLines, AFullSocketLosesLines) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  const UniqueFd read{ends[0]};
  const UniqueFd write{ends[1]};
  EXPECT_GT(linesUntilOneIsLost(StderrLines{write.get()}), 0);
}

TEST(StderrLines, APipeWithoutReaderLosesLines) {
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  auto [read, write] = pipeEnds();
  read.reset();
  EXPECT_FALSE(StderrLines{write.get()}.tell("to nobody"));
  std::signal(SIGPIPE, before);
}

TEST(StderrLines, ATerminalThatIsHeldOrNotReadLosesLines) {
  int master = -1;
  int slave = -1;
  ASSERT_EQ(::openpty(&master, &slave, nullptr, nullptr, nullptr), 0);
  const UniqueFd read{master};
  const UniqueFd terminal{slave};
  const StderrLines lines{terminal.get()};
  ASSERT_EQ(::tcflow(terminal.get(), TCOOFF), 0) << "as by Ctrl-S";
  EXPECT_FALSE(lines.tell("held"));
  ASSERT_EQ(::tcflow(terminal.get(), TCOON), 0);
  EXPECT_TRUE(lines.tell("told"));
  EXPECT_GT(linesUntilOneIsLost(lines), 0);
}

}  // namespace
}  // namespace rc10::test::stderr_lines_test
