#pragma once

#include <optional>
#include <set>
#include <string>

#include "config/keys/settings.hpp"
#include "config/yaml/problem.hpp"
#include "config/yaml/yaml_node.hpp"

namespace rc10 {

/// The profiles of the document, and which of them motors use.
class Profiles {
 public:
  /// `root`: the checked document, which must live longer.
  explicit Profiles(const YamlNode& root);

  /// The motor's own keys over those of the profile it names. Nothing if the profile cannot be used:
  /// that has been reported, and what is missing without it is no second mistake.
  [[nodiscard]] std::optional<Settings> settingsOf(const YamlNode& motor, const std::string& path,
                                                   Problems& problems);

  /// Warns of profiles that no motor uses.
  void checkUse(Problems& problems) const;

 private:
  const YamlNode* profiles_ = nullptr;
  std::set<std::string> used_;
  bool misspelt_ = false;
};

}  // namespace rc10
