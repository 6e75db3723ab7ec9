#include "config/keys/key_table.hpp"

#include <algorithm>

namespace rc10 {

constexpr TextForm kNameForm{"[a-z0-9_]{1,31}", "1 to 31 of a-z, 0-9 and _"};

const Key* findKey(const Section& section, std::string_view name) {
  const auto keys = section.keys();
  const auto found =
      std::find_if(keys.begin(), keys.end(), [name](const Key& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

}  // namespace rc10
