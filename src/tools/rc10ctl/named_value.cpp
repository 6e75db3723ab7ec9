#include "named_value.hpp"

#include <exception>

namespace rc10::ctl {

Result<link::NamedValue> namedValue(const std::string& text, std::string_view example) {
  const auto equals = text.find('=');
  link::NamedValue value;
  try {
    std::size_t used = 0;
    if (equals != std::string::npos && equals > 0 && equals < sizeof value.name.chars) {
      value.name = std::string_view{text}.substr(0, equals);
      value.value = std::stod(text.substr(equals + 1), &used);
      if (used == text.size() - equals - 1) return value;
    }
  } catch (const std::exception&) {  // no number: as below
  }
  return fail("'" + text + "' is no NAME=NUMBER; write for example " + std::string{example});
}

}  // namespace rc10::ctl
