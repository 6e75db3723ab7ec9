#include "client/json_line.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace rc10::client {

std::string lineOf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

double shortest(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double result = static_cast<double>(value);
  std::from_chars(text.data(), end, result);
  return result;
}

Json listOf(const std::string& words) {
  Json list = Json::array();
  for (std::size_t start = 0; start < words.size();) {
    const std::size_t end = std::min(words.find(',', start), words.size());
    list.push_back(words.substr(start, end - start));
    start = end + 1;
  }
  return list;
}

}  // namespace rc10::client
