#include "web/bounded_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "app/sanitizers.hpp"

namespace rc10::web::test::bounded_child_test {
namespace {

using ::testing::HasSubstr;

const MonotonicTime kNow{};

// Until its answer is there; the time that the child is given stands still.
Result<std::string> answerOf(BoundedChild::Work work, std::string_view input,
                             const ChildLimits& limits = {}) {
  auto child = BoundedChild::start(work, input, kNow, limits);
  if (!child) return tl::unexpected(child.error());
  while (true) {
    if (auto answer = child->poll(kNow)) return std::move(*answer);
    (void)::poll(nullptr, 0, 1);
  }
}

TEST(BoundedChild, AnswersWithWhatTheWorkMakesOfTheText) {
  const auto answer = answerOf([](std::string_view text) { return std::string{text} + "!"; }, "good");
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, "good!");
}

TEST(BoundedChild, AnAnswerLongerThanAPipeArrivesWhole) {
  const auto answer = answerOf([](std::string_view) { return std::string(1'000'000, 'x'); }, "");
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, std::string(1'000'000, 'x'));
}

TEST(BoundedChild, WorkThatCrashesIsAnErrorAndNothingElse) {
  const auto answer = answerOf([](std::string_view) -> std::string { ::_exit(7); }, "");
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("ended without an answer"));
}

TEST(BoundedChild, WorkThatThrowsIsAnError) {
  EXPECT_FALSE(answerOf([](std::string_view) -> std::string { throw std::runtime_error{"no"}; }, ""));
}

TEST(BoundedChild, WorkWithoutAnEndIsEndedByItsTimeOfTheProcessor) {
  const auto answer = answerOf(
      [](std::string_view) -> std::string {
        while (true) (void)::getppid();
      },
      "", {.cpu_s = 1});
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("too much time"));
}

TEST(BoundedChild, WorkThatSleepsIsEndedWhenThePatienceIs) {
  auto child = BoundedChild::start(
      [](std::string_view) -> std::string {
        while (true) ::pause();
      },
      "", kNow);
  ASSERT_TRUE(child);
  EXPECT_FALSE(child->poll(kNow));
  const auto answer = child->poll(kNow + ChildLimits{}.patience);
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->error().message, HasSubstr("too much time"));
}

TEST(BoundedChild, AnAnswerWithoutAnEndIsCutOff) {
  const auto answer =
      answerOf([](std::string_view) { return std::string(100'000, 'x'); }, "", {.answer_bytes = 50'000});
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("more to say"));
}

TEST(BoundedChild, MemoryWithoutAnEndIsRefused) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer has a shadow of the whole memory";
  const auto work = [](std::string_view) {
    return std::to_string(std::vector<char>(1UL << 30U, 'x').size());
  };
  EXPECT_FALSE(answerOf(work, ""));
}

TEST(BoundedChild, OpensNoFileAndHasNoneOfTheServers) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer opens files";
  const auto answer = answerOf(
      [](std::string_view) {
        std::string open;
        for (const char* path : {"/etc/passwd", "/dev/null", "/proc/self/maps"})
          if (::open(path, O_RDONLY | O_CLOEXEC) >= 0) open += path;
        if (::open("/tmp", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600) >= 0) open += "/tmp";
        if (::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0) >= 0) open += "socket";
        for (int fd = 1; fd < 100; ++fd)
          if (::fcntl(fd, F_GETFD) >= 0) open += std::to_string(fd) + " ";
        return open.empty() ? std::string{"none"} : open;
      },
      "");
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, "none");
}

TEST(BoundedChild, OneThatIsGivenUpEnds) {
  {
    const auto child = BoundedChild::start(
        [](std::string_view) -> std::string {
          while (true) ::pause();
        },
        "", kNow);
    ASSERT_TRUE(child);
  }
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

}  // namespace
}  // namespace rc10::web::test::bounded_child_test
