#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "daemon/exchange/orders.hpp"

namespace rc10 {

/// Requests to enable motors, whose answers wait for the drives. Scheduler thread only.
class PendingEnables {
 public:
  [[nodiscard]] bool full() const noexcept {
    return std::all_of(places_.begin(), places_.end(), [](const Place& place) { return waits(place); });
  }
  /// While it is not full. `waiting`: some motor.
  void add(const OrderResult& result, const MotorSet& waiting) noexcept {
    const auto free =
        std::find_if(places_.begin(), places_.end(), [](const Place& place) { return !waits(place); });
    if (free != places_.end()) *free = {result, waiting};
  }
  /// `answer(OrderResult)` is called for each request whose last motor this was.
  template <typename Answer>
  void settle(std::size_t motor, Refusal outcome, Answer answer) noexcept {
    for (auto& place : places_) {
      if (!place.waiting.test(motor)) continue;
      place.result.motors[motor] = outcome;
      place.waiting.reset(motor);
      if (place.waiting.none()) answer(place.result);
    }
  }

 private:
  struct Place {
    OrderResult result;
    MotorSet waiting;  ///< Empty: the place is free.
  };
  [[nodiscard]] static bool waits(const Place& place) noexcept { return place.waiting.any(); }

  std::array<Place, kMaxOpenRequests> places_{};
};

}  // namespace rc10
