#include "robot_file/program_run.hpp"

#include <fcntl.h>
#include <grp.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include "app/errno_text.hpp"
#include "app/unique_fd.hpp"

namespace rc10::robot_file {
namespace {

constexpr std::size_t kMostOutput = std::size_t{32} << 10U;
constexpr int kSignalled = 128;

bool limit(__rlimit_resource resource, rlim_t most) {
  const rlimit bound{.rlim_cur = most, .rlim_max = most};
  return ::setrlimit(resource, &bound) == 0;
}

bool become(const LesserUser& as) {
  const bool bounded = limit(RLIMIT_CPU, as.cpu_s) && limit(RLIMIT_AS, as.memory_bytes) &&
                       limit(RLIMIT_CORE, 0) && limit(RLIMIT_FSIZE, 0);
  // The same user has already no right to change it.
  const bool same = ::geteuid() == as.user;
  return bounded &&
         (same || (::setgroups(0, nullptr) == 0 && ::setgid(as.group) == 0 && ::setuid(as.user) == 0));
}

[[noreturn]] void exec(const std::vector<std::string>& words, int input, int output,
                       const std::optional<LesserUser>& as) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  std::array<char*, 1> environment{nullptr};
  if (::dup2(input, STDIN_FILENO) < 0 || ::dup2(output, STDOUT_FILENO) < 0 ||
      ::dup2(output, STDERR_FILENO) < 0 || (as && !become(*as)))
    ::_exit(ProgramEnd::kNotStarted);
  (void)::execve(arguments.front(), arguments.data(), environment.data());
  ::_exit(ProgramEnd::kNotStarted);
}

// To its end, so that the program never waits for us; the first part of it counts.
std::string readAll(int from) {
  std::string text;
  std::array<char, 4096> bytes{};
  for (;;) {
    const auto size = ::read(from, bytes.data(), bytes.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return text;
    if (text.size() < kMostOutput) text.append(bytes.data(), static_cast<std::size_t>(size));
  }
}

}  // namespace

Result<ProgramEnd> runProgram(const std::vector<std::string>& words, const std::string& input,
                              const std::optional<LesserUser>& as) {
  // Opened anew by its path, so that a lesser user may read it and it begins at its beginning.
  UniqueFd text{::memfd_create("input", MFD_CLOEXEC)};
  std::array<int, 2> ends{-1, -1};
  if (!text || ::ftruncate(text.get(), static_cast<off_t>(input.size())) != 0 ||
      ::pwrite(text.get(), input.data(), input.size(), 0) != static_cast<ssize_t>(input.size()) ||
      ::pipe2(ends.data(), O_CLOEXEC) != 0)
    return fail("cannot start " + words.front() + ": " + errnoText(errno));
  const UniqueFd told{ends[0]};
  UniqueFd telling{ends[1]};
  const pid_t pid = ::fork();
  if (pid < 0) return fail("cannot start " + words.front() + ": " + errnoText(errno));
  if (pid == 0) exec(words, text.get(), telling.get(), as);
  telling.reset();
  ProgramEnd end{.output = readAll(told.get())};
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) return fail("cannot wait for " + words.front() + ": " + errnoText(errno));
  }
  end.status = WIFEXITED(status) ? WEXITSTATUS(status) : kSignalled + WTERMSIG(status);
  return end;
}

}  // namespace rc10::robot_file
