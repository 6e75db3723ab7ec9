#pragma once

#include <string>
#include <string_view>

namespace rc10 {

/// Writes indented JSON, member by member: `json.key("a").text("b")`.
class JsonWriter {
 public:
  JsonWriter& object() { return open('{'); }
  JsonWriter& endObject() { return close('}'); }
  JsonWriter& array() { return open('['); }
  JsonWriter& endArray() { return close(']'); }
  JsonWriter& key(std::string_view name);
  JsonWriter& text(std::string_view value);
  JsonWriter& number(double value);
  JsonWriter& boolean(bool value) { return literal(value ? "true" : "false"); }
  /// Something that is JSON already.
  JsonWriter& literal(std::string_view json);

  /// The whole text, with a line feed at its end.
  [[nodiscard]] std::string result() const { return json_ + "\n"; }

 private:
  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  void beginValue();
  void newLine();

  std::string json_;
  int depth_ = 0;
  bool first_ = true;  ///< Nothing stands yet in the innermost object or array.
  bool after_key_ = false;
};

}  // namespace rc10
