#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "doctor/host_files.hpp"

namespace rc10::doctor {

/// Files of a kernel that a test writes.
class HostRoot {
 public:
  HostRoot() {
    std::string name = "/tmp/rc10-doctor-XXXXXX";
    root_ = ::mkdtemp(name.data());
  }
  ~HostRoot() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  HostRoot(const HostRoot&) = delete;
  HostRoot& operator=(const HostRoot&) = delete;

  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((root_ + path).substr(0, (root_ + path).rfind('/')));
    std::ofstream(root_ + path) << text << '\n';
  }
  void link(const std::string& path, const std::string& target) const {
    std::filesystem::create_directories((root_ + path).substr(0, (root_ + path).rfind('/')));
    std::filesystem::create_symlink(target, root_ + path);
  }
  [[nodiscard]] HostFiles files() const { return HostFiles(root_); }

 private:
  std::string root_;
};

}  // namespace rc10::doctor
