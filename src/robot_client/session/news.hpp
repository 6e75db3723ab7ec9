#pragma once

#include <string>
#include <vector>

#include "robot_client/session/moves.hpp"
#include "robot_client/session/problems.hpp"

namespace rc10 {
inline namespace robot_client {

/// Moves that ended and problems that arose under the mutex, for the time when it is released.
struct News {
  std::vector<Moves::Ended> moves;
  std::vector<std::string> problems;

  [[nodiscard]] bool empty() const noexcept { return moves.empty() && problems.empty(); }
  void tell(Problems& to) {
    for (auto& move : moves) move.tell();
    for (const auto& problem : problems) to.tell(problem);
  }
};

}  // namespace robot_client
}  // namespace rc10
