#include "robot_client/session/moves.hpp"

#include <algorithm>

namespace rc10 {
inline namespace robot_client {
namespace {

constexpr Duration kLookAgain = std::chrono::milliseconds{20};

}  // namespace

void Moves::start(MoveWatch watch, std::promise<MoveResult> promise) {
  moves_.push_back({std::move(watch), std::move(promise)});
}

// Backwards through all, since one that ends leaves the list.
void Moves::onState(const RobotState& state, MonotonicTime now, std::vector<Ended>& ended) {
  for (std::size_t i = moves_.size(); i-- > 0;) {
    if (auto result = moves_[i].watch.onState(state, now)) end(i, std::move(*result), ended);
  }
}

void Moves::onEvent(const Event& event) {
  for (auto& move : moves_) move.watch.onEvent(event);
}

void Moves::onTime(MonotonicTime now, std::vector<Ended>& ended) {
  for (std::size_t i = moves_.size(); i-- > 0;) {
    if (auto result = moves_[i].watch.onTime(now)) end(i, std::move(*result), ended);
  }
}

void Moves::supersede(const MotorSetpoints& setpoints, std::vector<Ended>& ended) {
  for (const auto& order : setpoints) {
    for (std::size_t i = moves_.size(); i-- > 0;) {
      auto& move = moves_[i];
      if (move.watch.motor() != order.motor) continue;
      ended.push_back(
          {std::move(move.promise), move.watch.failed(order.motor + " was given another target")});
      moves_.erase(moves_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

void Moves::fail(const std::string& motor, const std::string& reason, std::vector<Ended>& ended) {
  for (std::size_t i = moves_.size(); i-- > 0;) {
    if (moves_[i].watch.motor() == motor) end(i, moves_[i].watch.failed(reason), ended);
  }
}

void Moves::failAll(const std::string& reason, std::vector<Ended>& ended) {
  for (std::size_t i = moves_.size(); i-- > 0;) end(i, moves_[i].watch.failed(reason), ended);
}

std::optional<MonotonicTime> Moves::nextLook(MonotonicTime now) const {
  if (moves_.empty()) return std::nullopt;
  auto next = now + kLookAgain;
  for (const auto& move : moves_) next = std::min(next, move.watch.deadline());
  return next;
}

void Moves::end(std::size_t move, MoveResult result, std::vector<Ended>& ended) {
  if (result.outcome == MoveResult::Outcome::kFailed) held_.release(moves_[move].watch.motor());
  ended.push_back({std::move(moves_[move].promise), std::move(result)});
  moves_.erase(moves_.begin() + static_cast<std::ptrdiff_t>(move));
}

}  // namespace robot_client
}  // namespace rc10
