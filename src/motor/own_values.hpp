#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace rc10 {

/// The values of the keys that only one family, or one type of module, knows, defaults filled in.
class OwnValues {
 public:
  /// A flag is 0 or 1, a motor its place in the robot's list, a section one of its rows.
  using Value = std::variant<double, std::string, std::vector<OwnValues>>;

  void set(std::string_view key, Value value);
  /// Whether it was written, or has a default.
  [[nodiscard]] bool given(std::string_view key) const { return find(key) != nullptr; }
  /// 0 if there is no such key: a family asks only for keys that it has declared.
  [[nodiscard]] double number(std::string_view key) const;
  [[nodiscard]] int integer(std::string_view key) const { return static_cast<int>(number(key)); }
  [[nodiscard]] bool flag(std::string_view key) const { return number(key) != 0.0; }
  [[nodiscard]] std::string text(std::string_view key) const;
  /// The place of a motor.
  [[nodiscard]] std::size_t motor(std::string_view key) const {
    return static_cast<std::size_t>(number(key));
  }
  /// The maps of a list; one for a section; none if it was not written.
  [[nodiscard]] const std::vector<OwnValues>& rows(std::string_view key) const;
  /// Empty if it was not written.
  [[nodiscard]] const OwnValues& section(std::string_view key) const;

 private:
  [[nodiscard]] const Value* find(std::string_view key) const;

  std::vector<std::pair<std::string, Value>> values_;
};

}  // namespace rc10
