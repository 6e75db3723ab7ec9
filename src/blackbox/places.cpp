#include "blackbox/places.hpp"

#include <cstdlib>

namespace rc10::blackbox {
namespace {

[[nodiscard]] std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

}  // namespace

std::string livePath(const std::string& run_dir, const std::string& robot) {
  return run_dir + "/" + robot + ".blackbox";
}

std::string stateDir() {
  if (auto dir = environment("RC10_STATE_DIR"); !dir.empty()) return dir;
  // systemd.exec(5): several are separated by colons.
  const auto dirs = environment("STATE_DIRECTORY");
  if (auto first = dirs.substr(0, dirs.find(':')); !first.empty()) return first;
  return "/var/lib/rc10d";
}

}  // namespace rc10::blackbox
