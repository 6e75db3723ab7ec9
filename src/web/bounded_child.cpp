#include "web/bounded_child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>
#include <utility>
#include <vector>

#include "app/errno_text.hpp"
#include "app/sanitizers.hpp"

namespace rc10::web {
namespace {

constexpr int kGood = 0;
constexpr int kNoAnswer = 1;

void limit(__rlimit_resource resource, rlim_t most) {
  rlimit bound{};
  if (::getrlimit(resource, &bound) != 0) ::_exit(kNoAnswer);
  bound.rlim_max = std::min(bound.rlim_max, most);
  bound.rlim_cur = bound.rlim_max;
  // Without its bounds the text of a stranger is not touched.
  if (::setrlimit(resource, &bound) != 0) ::_exit(kNoAnswer);
}

// All but one; a sanitizer reports on the standard ones.
void closeOthers(int kept) {
  const int first = kSanitized ? STDERR_FILENO + 1 : STDIN_FILENO;
  const auto descriptor = static_cast<unsigned>(kept);
  if (kept > first) (void)::close_range(static_cast<unsigned>(first), descriptor - 1, 0);
  (void)::close_range(std::max(descriptor + 1, static_cast<unsigned>(first)), ~0U, 0);
}

void shutIn(int answers, const ChildLimits& limits) {
  for (const int each : {SIGINT, SIGTERM, SIGPIPE, SIGALRM}) (void)std::signal(each, SIG_DFL);
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  (void)::alarm(static_cast<unsigned>(limits.patience.count()));
  closeOthers(answers);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CPU, limits.cpu_s);
  // A sanitizer opens files and has a shadow of the whole memory.
  if (kSanitized) return;
  limit(RLIMIT_NOFILE, 0);
  limit(RLIMIT_AS, limits.memory_bytes);
}

[[noreturn]] void answerAndEnd(const BoundedChild::Work& work, int answers) {
  try {
    const auto answer = work();
    std::string_view left = answer;
    while (!left.empty()) {
      const auto written = ::write(answers, left.data(), left.size());
      if (written <= 0) ::_exit(kNoAnswer);
      left.remove_prefix(static_cast<std::size_t>(written));
    }
  } catch (...) {
    ::_exit(kNoAnswer);
  }
  // Nothing of the server's is run at its end.
  ::_exit(kGood);
}

std::string endOf(int status) {
  if (WIFSIGNALED(status) &&
      (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGALRM))
    return "the text takes too much time or memory; shorten it";
  return "the text cannot be read: the process that read it ended without an answer; shorten it";
}

}  // namespace

BoundedChild::BoundedChild(pid_t pid, UniqueFd answers, MonotonicTime deadline, std::size_t most)
    : pid_(pid), answers_(std::move(answers)), deadline_(deadline), most_bytes_(most) {}

BoundedChild::BoundedChild(BoundedChild&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      answers_(std::move(other.answers_)),
      deadline_(other.deadline_),
      most_bytes_(other.most_bytes_),
      answer_(std::move(other.answer_)) {}

BoundedChild::~BoundedChild() { end(); }

Result<BoundedChild> BoundedChild::start(const Work& work, MonotonicTime now, const ChildLimits& limits) {
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return fail("no pipe: " + errnoText(errno));
  UniqueFd answers{ends[0]};
  const UniqueFd told{ends[1]};
  if (::fcntl(answers.get(), F_SETFL, O_NONBLOCK) != 0) return fail("no pipe: " + errnoText(errno));
  const pid_t pid = ::fork();
  if (pid < 0) return fail("no process: " + errnoText(errno));
  if (pid == 0) {
    shutIn(told.get(), limits);
    answerAndEnd(work, told.get());
  }
  return BoundedChild{pid, std::move(answers), now + limits.patience, limits.answer_bytes};
}

// Never waits: what has not ended yet is reaped with a later one.
void BoundedChild::end() noexcept {
  if (pid_ < 0) return;
  answers_ = UniqueFd{};
  static std::vector<pid_t> given_up;
  given_up.push_back(std::exchange(pid_, -1));
  std::erase_if(given_up, [](pid_t pid) { return ::waitpid(pid, nullptr, WNOHANG) != 0; });
}

// False: the child has closed its end.
bool BoundedChild::takeBytes() {
  std::array<char, 16384> bytes{};
  while (answer_.size() <= most_bytes_) {
    const auto size = ::read(answers_.get(), bytes.data(), bytes.size());
    if (size < 0) return errno == EAGAIN || errno == EINTR;
    if (size == 0) return false;
    answer_.append(bytes.data(), static_cast<std::size_t>(size));
  }
  return true;
}

std::optional<Result<std::string>> BoundedChild::poll(MonotonicTime now) {
  if (pid_ < 0) return std::nullopt;
  const bool more = takeBytes();
  if (answer_.size() > most_bytes_) {
    end();
    return fail("there is more to say about this text than a page shows; shorten it");
  }
  int status = 0;
  if (!more && ::waitpid(pid_, &status, WNOHANG) == pid_) {
    pid_ = -1;
    if (WIFEXITED(status) && WEXITSTATUS(status) == kGood) return std::move(answer_);
    return fail(endOf(status));
  }
  if (now < deadline_) return std::nullopt;
  end();
  return fail("the text takes too much time; shorten it");
}

}  // namespace rc10::web
