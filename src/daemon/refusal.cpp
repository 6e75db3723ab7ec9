#include "daemon/refusal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>

#include "app/unique_fd.hpp"
#include "link/run_dir.hpp"

namespace rc10 {

void leaveRefusal(const std::string& config_file, const std::string& text) {
  if (!link::makeRunDir(link::runDir())) return;
  const auto path = link::refusalPath(link::runDir(), config_file);
  const auto temporary = path + ".new";
  (void)::unlink(temporary.c_str());
  UniqueFd file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW,
                       S_IRUSR | S_IWUSR | S_IRGRP)};
  if (!file || ::write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) return;
  file.reset();
  (void)std::rename(temporary.c_str(), path.c_str());
}

void takeRefusalBack(const std::string& config_file) {
  (void)::unlink(link::refusalPath(link::runDir(), config_file).c_str());
}

}  // namespace rc10
