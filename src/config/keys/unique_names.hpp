#pragma once

#include <map>
#include <string>

#include "config/keys/settings.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Refuses a name that has been given before.
class UniqueNames {
 public:
  /// `what` is unique in `where`: "motor name", "the robot".
  UniqueNames(std::string what, std::string where) : what_(std::move(what)), where_(std::move(where)) {}

  void add(const GivenValue& name, Problems& problems) {
    const auto [first, is_new] = given_.emplace(name.text(), name);
    if (is_new) return;
    problems.error(name.place(), name.path,
                   what_ + " " + inQuotes(name.text()) + " is taken by " + first->second.path + " (line " +
                       std::to_string(first->second.place().line) + "); it must be unique in " + where_);
  }

 private:
  std::string what_;
  std::string where_;
  std::map<std::string, GivenValue> given_;
};

}  // namespace rc10
