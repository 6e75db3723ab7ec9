#include "config/motor_families.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "config/keys/motor_keys.hpp"

namespace rc10 {
namespace {

[[nodiscard]] std::vector<FamilyEntry>& entries() {
  static std::vector<FamilyEntry> all{builtInFamilies().begin(), builtInFamilies().end()};
  return all;
}

}  // namespace

std::span<const FamilyEntry> motorFamilies() { return entries(); }

Result<void> addMotorFamily(const FamilyEntry& entry) {
  const std::string who = "motor family '" + std::string{entry.family->name()} + "': ";
  if (motorKeysMade()) return fail(who + "a configuration has been read already; add families before that");
  for (const auto model : entry.family->models()) {
    if (const auto* other = findFamily(model); other != nullptr) {
      return fail(who + "model " + std::string{model} + " is one of family '" +
                  std::string{other->family->name()} + "'; give it another name");
    }
  }
  for (const OwnKey& key : entry.family->keys()) {
    if (isCommonMotorKey(key.name)) {
      return fail(who + "every motor has a key '" + std::string{key.name} + "'; give it another name");
    }
  }
  entries().push_back(entry);
  return {};
}

const FamilyEntry* findFamily(std::string_view model) {
  const auto& all = entries();
  const auto found = std::find_if(all.begin(), all.end(), [model](const FamilyEntry& entry) {
    const auto models = entry.family->models();
    return std::find(models.begin(), models.end(), model) != models.end();
  });
  return found != all.end() ? &*found : nullptr;
}

}  // namespace rc10
