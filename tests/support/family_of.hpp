#pragma once

#include <stdexcept>
#include <string>

#include "drives/families.hpp"

namespace rc10::test {

/// The built-in family that has this model.
inline const FamilyEntry& familyOf(const std::string& model) {
  for (const auto& entry : builtInFamilies()) {
    for (const auto known : entry.family->models()) {
      if (known == model) return entry;
    }
  }
  throw std::invalid_argument(model);
}

}  // namespace rc10::test
