#include "daemon/log_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace rc10 {

void LogFile::keepIn(std::string path) {
  const std::lock_guard lock{mutex_};
  path_ = std::move(path);
  (void)::unlink((path_ + ".1").c_str());
  open();
  write(std::exchange(early_, {}));
}

// Always a new file: nobody has put a link in its place.
void LogFile::open() {
  (void)::unlink(path_.c_str());
  file_ = UniqueFd{::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC | O_NOFOLLOW,
                          S_IRUSR | S_IWUSR | S_IRGRP)};
  bytes_ = 0;
}

void LogFile::sink_it_(const spdlog::details::log_msg& message) {
  spdlog::memory_buf_t line;
  formatter_->format(message, line);
  write({line.data(), line.size()});
}

void LogFile::write(std::string_view line) {
  if (path_.empty()) {
    if (early_.size() + line.size() <= kMostBytes) early_ += line;
    return;
  }
  if (bytes_ + line.size() > kMostBytes) {
    (void)std::rename(path_.c_str(), (path_ + ".1").c_str());
    open();
  }
  // A full disk has room again when others make it: the log goes on without these lines.
  if (file_ && ::write(file_.get(), line.data(), line.size()) > 0) bytes_ += line.size();
}

}  // namespace rc10
