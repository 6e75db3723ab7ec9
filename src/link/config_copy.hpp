#pragma once

#include <filesystem>
#include <string>

namespace rc10::link {

/// Bytes of the file with which a robot last started, for rc10-web: <run_dir>/<robot>.config.
[[nodiscard]] inline std::string configPath(const std::string& run_dir, const std::string& robot) {
  return run_dir + "/" + robot + ".config";
}

/// Bytes of the file beside its refusal: <run_dir>/<name of the file>.refused.
[[nodiscard]] inline std::string refusedPath(const std::string& run_dir, const std::string& config_file) {
  return run_dir + "/" + std::filesystem::path(config_file).stem().string() + ".refused";
}

}  // namespace rc10::link
