#include "web/bounded_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <optional>
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
Result<std::string> answerOf(const BoundedChild::Work& work, const ChildLimits& limits = {}) {
  auto child = BoundedChild::start(work, kNow, limits);
  if (!child) return tl::unexpected(child.error());
  while (true) {
    if (auto answer = child->poll(kNow)) return std::move(*answer);
    (void)::poll(nullptr, 0, 1);
  }
}

TEST(BoundedChild, AnswersWithWhatTheWorkMakesOfTheMemory) {
  const std::string text = "good";
  const auto answer = answerOf([&] { return text + "!"; });
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, "good!");
}

TEST(BoundedChild, AnAnswerLongerThanAPipeArrivesWhole) {
  const auto answer = answerOf([] { return std::string(1'000'000, 'x'); });
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, std::string(1'000'000, 'x'));
}

TEST(BoundedChild, WorkThatCrashesIsAnErrorAndNothingElse) {
  const auto answer = answerOf([]() -> std::string { ::_exit(7); });
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("ended without an answer"));
}

TEST(BoundedChild, WorkThatThrowsIsAnError) {
  EXPECT_FALSE(answerOf([]() -> std::string { throw std::runtime_error{"no"}; }));
}

TEST(BoundedChild, WorkWithoutAnEndIsEndedByItsTimeOfTheProcessor) {
  const auto answer = answerOf(
      []() -> std::string {
        while (true) (void)::getppid();
      },
      {.cpu_s = 1});
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("too much time"));
}

TEST(BoundedChild, WorkThatSleepsIsEndedWhenThePatienceIs) {
  auto child = BoundedChild::start(
      []() -> std::string {
        while (true) ::pause();
      },
      kNow);
  ASSERT_TRUE(child);
  EXPECT_FALSE(child->poll(kNow));
  const auto answer = child->poll(kNow + ChildLimits{}.patience);
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->error().message, HasSubstr("too much time"));
}

TEST(BoundedChild, AnAnswerWithoutAnEndIsCutOff) {
  const auto answer = answerOf([] { return std::string(100'000, 'x'); }, {.answer_bytes = 50'000});
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("more to say"));
}

#if !RC10_SANITIZED  // A sanitizer has a shadow of the whole memory, and opens files.
TEST(BoundedChild, MemoryWithoutAnEndIsRefused) {
  const auto work = [] { return std::to_string(std::vector<char>(1UL << 30U, 'x').size()); };
  EXPECT_FALSE(answerOf(work));
}

TEST(BoundedChild, OpensNoFileAndHasNoneOfTheServers) {
  const auto answer = answerOf([] {
    std::string open;
    for (const char* path : {"/etc/passwd", "/dev/null", "/proc/self/maps"})
      if (::open(path, O_RDONLY | O_CLOEXEC) >= 0) open += path;
    if (::open("/tmp", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600) >= 0) open += "/tmp";
    if (::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0) >= 0) open += "socket";
    int descriptors = 0;
    for (int fd = 0; fd < 100; ++fd) descriptors += ::fcntl(fd, F_GETFD) >= 0 ? 1 : 0;
    if (descriptors != 1) open += std::to_string(descriptors) + " descriptors";
    return open.empty() ? std::string{"none"} : open;
  });
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, "none");
}
#endif

// A process without other children.
void inFreshProcess(const std::function<bool()>& check) {
  const pid_t pid = ::fork();
  if (pid == 0) ::_exit(check() ? 0 : 1);
  int status = 0;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);
  EXPECT_EQ(status, 0);
}

// The signal that ended the only child; 0: it was reaped before.
std::optional<int> signalOfTheChild() {
  int status = 0;
  if (::waitpid(-1, &status, 0) < 0) return errno == ECHILD ? std::optional{0} : std::nullopt;
  return WIFSIGNALED(status) ? std::optional{WTERMSIG(status)} : std::nullopt;
}

TEST(BoundedChild, OneThatIsGivenUpEndsAtItsNextWrite) {
  inFreshProcess([] {
    (void)BoundedChild::start([] { return std::string(1'000'000, 'x'); }, kNow);
    const auto signal = signalOfTheChild();
    return signal == SIGPIPE || signal == 0;
  });
}

TEST(BoundedChild, OneThatIsGivenUpAndSleepsEndsWithItsPatience) {
  inFreshProcess([] {
    const auto sleep = []() -> std::string {
      while (true) ::pause();
    };
    (void)BoundedChild::start(sleep, kNow, {.patience = std::chrono::seconds{1}});
    return signalOfTheChild() == SIGALRM;
  });
}

}  // namespace
}  // namespace rc10::web::test::bounded_child_test
