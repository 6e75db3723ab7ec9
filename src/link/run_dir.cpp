#include "link/run_dir.hpp"

#include <cstdlib>
#include <filesystem>

namespace rc10::link {

std::string runDir() {
  const char* dir = std::getenv("RC10_RUN_DIR");
  return dir != nullptr && *dir != '\0' ? dir : "/run/rc10d";
}

std::string socketPath(const std::string& robot) { return runDir() + "/" + robot + ".sock"; }

std::string estopPath(const std::string& socket_path) {
  return std::filesystem::path(socket_path).replace_extension(".estop").string();
}

std::string restFramesPath(const std::string& run_dir, const std::string& robot) {
  return run_dir + "/" + robot + "/rest-frames";
}

std::string guardSocketPath(const std::string& run_dir) { return run_dir + "/guard.socket"; }

}  // namespace rc10::link
