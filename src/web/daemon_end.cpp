#include "web/daemon_end.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "link/run_dir.hpp"
#include "web/left_files.hpp"

namespace rc10::web {
namespace {

constexpr off_t kMostBytes = off_t{16} << 10U;
constexpr std::ptrdiff_t kMostLines = 60;
// Lines of the log that a refused start may still write.
constexpr std::int64_t kSameStartSeconds = 10;

struct FoundText {
  std::string text;
  timespec written{};
};

std::optional<FoundText> endOf(const std::string& path) {
  struct stat status {};
  const auto file = openLeftFile(path, status);
  if (!file) return std::nullopt;
  const auto begin = std::max<off_t>(0, status.st_size - kMostBytes);
  std::string text(static_cast<std::size_t>(status.st_size - begin), '\0');
  const auto size = ::pread(file.get(), text.data(), text.size(), begin);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  if (begin > 0) text.erase(0, std::min(text.find('\n'), text.size() - 1) + 1);
  return FoundText{std::move(text), status.st_mtim};
}

std::string lastLines(const std::string& text) {
  std::size_t begin = text.size();
  for (std::ptrdiff_t lines = 0; begin > 0 && lines <= kMostLines; ++lines)
    begin = text.rfind('\n', begin - 1) == std::string::npos ? 0 : text.rfind('\n', begin - 1);
  return begin == 0 ? text : text.substr(begin + 1);
}

}  // namespace

DaemonEnd readDaemonEnd(const std::string& run_dir, const std::optional<std::string>& robot) {
  DaemonEnd end;
  const auto path =
      robot && namesFiles(*robot) ? link::logPath(run_dir, *robot) : newestLeftFile(run_dir, ".log");
  if (const auto log = endOf(path)) {
    const auto before = endOf(path + ".1");
    end.log = lastLines((before ? before->text : std::string{}) + log->text);
    end.logged_at = log->written.tv_sec;
  }
  const auto refusal = endOf(newestLeftFile(run_dir, ".refusal", robot));
  // One from before the last run says nothing about its end.
  if (refusal && refusal->written.tv_sec + kSameStartSeconds >= end.logged_at) {
    end.refusal = refusal->text;
    end.refused_at = refusal->written.tv_sec;
  }
  return end;
}

}  // namespace rc10::web
