#include "robot_client/session/motor_reasons.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using Known = std::function<bool(std::string_view)>;

// The pieces of `text` between separators.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, std::string_view separator) {
  std::vector<std::string_view> pieces;
  while (true) {
    const auto end = text.find(separator);
    pieces.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return pieces;
    text.remove_prefix(end + separator.size());
  }
}

// The names before the first ": ", if they are names of motors and nothing else.
[[nodiscard]] std::vector<std::string_view> namesOf(std::string_view piece, const Known& known) {
  const auto colon = piece.find(": ");
  if (colon == std::string_view::npos) return {};
  auto names = split(piece.substr(0, colon), ", ");
  for (const auto name : names) {
    if (!known(name)) return {};
  }
  return names;
}

}  // namespace

std::vector<MotorReason> motorReasons(std::string_view message, const Known& known) {
  std::vector<MotorReason> reasons;
  const auto open = message.find('(');
  const auto close = message.rfind(')');
  if (open == std::string_view::npos || close == std::string_view::npos || close < open) return reasons;
  std::size_t group = 0;  // the reasons from here on are of one piece
  for (const auto piece : split(message.substr(open + 1, close - open - 1), "; ")) {
    const auto names = namesOf(piece, known);
    if (names.empty()) {  // the reason before goes on
      for (auto i = group; i < reasons.size(); ++i) reasons[i].reason += "; " + std::string(piece);
      continue;
    }
    group = reasons.size();
    const auto reason = piece.substr(piece.find(": ") + 2);
    for (const auto name : names) reasons.push_back({std::string(name), std::string(reason)});
  }
  return reasons;
}

}  // namespace robot_client
}  // namespace rc10
