#pragma once

#include <optional>
#include <string>

namespace rc10::web {

/// Bytes of a robot's file, as rc10d left them in the run folder.
struct FoundConfig {
  std::string of = "none";  ///< "running", "last", "refused" (by the last start), "none".
  std::string text;
};

/// `robot` runs, with a file of this hash.
[[nodiscard]] FoundConfig readRunningConfig(const std::string& run_dir, const std::string& robot,
                                            const std::string& hash);
/// The file with which an rc10d started last, whether it runs or not.
struct AcceptedConfig {
  std::string robot;  ///< Named by its copy.
  std::string text;
};
/// That of `robot`; without a name that of the only robot that has left a copy. Nothing: there is none, or
/// several have.
[[nodiscard]] std::optional<AcceptedConfig> readAcceptedConfig(const std::string& run_dir,
                                                               const std::optional<std::string>& robot);
/// None runs: the newest file, of `robot` if it is named.
[[nodiscard]] FoundConfig readLastConfig(const std::string& run_dir, const std::optional<std::string>& robot);

}  // namespace rc10::web
