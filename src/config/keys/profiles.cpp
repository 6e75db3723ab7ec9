#include "config/keys/profiles.hpp"

#include <vector>

#include "config/keys/value_check.hpp"

namespace rc10 {
namespace {

constexpr const char* kProfiles = "profiles";

}  // namespace

Profiles::Profiles(const YamlNode& root) {
  const YamlNode* profiles = root.find(kProfiles);
  if (profiles != nullptr && !profiles->refused) profiles_ = profiles;
}

std::optional<Settings> Profiles::settingsOf(const YamlNode& motor, const std::string& path,
                                             Problems& problems) {
  const Settings own{{{&motor, path}}};
  const auto name = own.find("profile");
  if (!name) return own.mentions("profile") ? std::nullopt : std::optional{own};
  const YamlNode* profile = profiles_ == nullptr ? nullptr : profiles_->find(name->text());
  if (profile == nullptr) {
    misspelt_ = true;
    std::vector<std::string_view> known;
    if (profiles_ != nullptr) {
      for (const auto& entry : profiles_->entries) known.push_back(entry.key.text);
    }
    problems.error(name->place(), name->path,
                   known.empty() ? "there are no profiles; remove it, or add 'profiles:'"
                                 : notOneOf(name->text(), known));
    return std::nullopt;
  }
  used_.insert(name->text());
  if (profile->refused) return std::nullopt;
  return Settings{{{&motor, path}, {profile, joinPath(kProfiles, name->text())}}};
}

void Profiles::checkUse(Problems& problems) const {
  // A profile whose name a motor misspells is used.
  if (profiles_ == nullptr || misspelt_) return;
  for (const auto& entry : profiles_->entries) {
    if (used_.count(entry.key.text) != 0) continue;
    problems.warning(entry.key.place, joinPath(kProfiles, entry.key.text),
                     "no motor uses this profile; remove it");
  }
}

}  // namespace rc10
