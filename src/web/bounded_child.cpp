#include "web/bounded_child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "app/sanitizers.hpp"

namespace rc10::web {
namespace {

constexpr int kGood = 0;
constexpr int kNoAnswer = 1;

void limit(__rlimit_resource resource, rlim_t most) {
  const rlimit bound{.rlim_cur = most, .rlim_max = most};
  // Without its bounds the text of a stranger is not touched.
  if (::setrlimit(resource, &bound) != 0) ::_exit(kNoAnswer);
}

// The first to go when memory runs out.
void offerMemory() {
  const UniqueFd file{::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC)};
  if (file) (void)!::write(file.get(), "1000", 4);
}

void shutIn(int answers, const ChildLimits& limits) {
  for (const int each : {SIGINT, SIGTERM, SIGPIPE}) (void)std::signal(each, SIG_DFL);
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  offerMemory();
  // The only descriptor, and no room for another one.
  if (::dup2(answers, STDIN_FILENO) < 0) ::_exit(kNoAnswer);
  (void)::close_range(kSanitized ? STDERR_FILENO + 1 : STDIN_FILENO + 1, ~0U, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CPU, limits.cpu_s);
  // A sanitizer opens files and has a shadow of the whole memory.
  if (kSanitized) return;
  limit(RLIMIT_NOFILE, 1);
  limit(RLIMIT_AS, limits.memory_bytes);
}

[[noreturn]] void answerAndEnd(BoundedChild::Work work, std::string_view input) {
  try {
    const auto answer = work(input);
    std::string_view left = answer;
    while (!left.empty()) {
      const auto written = ::write(STDIN_FILENO, left.data(), left.size());
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
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
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

Result<BoundedChild> BoundedChild::start(Work work, std::string_view input, MonotonicTime now,
                                         const ChildLimits& limits) {
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return fail(std::string{"no pipe: "} + std::strerror(errno));
  UniqueFd answers{ends[0]};
  const UniqueFd told{ends[1]};
  if (::fcntl(answers.get(), F_SETFL, O_NONBLOCK) != 0)
    return fail(std::string{"no pipe: "} + std::strerror(errno));
  const pid_t pid = ::fork();
  if (pid < 0) return fail(std::string{"no process: "} + std::strerror(errno));
  if (pid == 0) {
    shutIn(told.get(), limits);
    answerAndEnd(work, input);
  }
  return BoundedChild{pid, std::move(answers), now + limits.patience, limits.answer_bytes};
}

void BoundedChild::end() noexcept {
  if (pid_ < 0) return;
  (void)::kill(pid_, SIGKILL);
  (void)::waitpid(pid_, nullptr, 0);
  pid_ = -1;
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
