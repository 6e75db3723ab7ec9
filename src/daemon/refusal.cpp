#include "daemon/refusal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>

#include "app/unique_fd.hpp"
#include "link/config_copy.hpp"
#include "link/run_dir.hpp"

namespace rc10 {
namespace {

// For the group of the run folder. It appears complete, or not at all.
void leave(const std::string& path, const std::string& bytes) {
  const auto temporary = path + ".new";
  (void)::unlink(temporary.c_str());
  UniqueFd file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW,
                       S_IRUSR | S_IWUSR | S_IRGRP)};
  if (!file || ::write(file.get(), bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) return;
  file.reset();
  (void)std::rename(temporary.c_str(), path.c_str());
}

}  // namespace

void leaveRefusal(const std::string& config_file, const std::string& text, const std::string& source) {
  if (!link::makeRunDir(link::runDir())) return;
  leave(link::refusedPath(link::runDir(), config_file), source);
  leave(link::refusalPath(link::runDir(), config_file), text);
}

void takeRefusalBack(const std::string& config_file) {
  (void)::unlink(link::refusalPath(link::runDir(), config_file).c_str());
  (void)::unlink(link::refusedPath(link::runDir(), config_file).c_str());
}

void leaveConfig(const std::string& robot, const std::string& source) {
  leave(link::configPath(link::runDir(), robot), source);
}

}  // namespace rc10
