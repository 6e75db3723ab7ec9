#include "robot_client/session/session_number.hpp"

#include <random>

namespace rc10 {
inline namespace robot_client {

std::int64_t newSessionNumber() {
  std::random_device device;
  const auto high = static_cast<std::uint64_t>(device()) << 32U;
  const auto number = static_cast<std::int64_t>((high | device()) >> 1U);
  return number == 0 ? 1 : number;
}

}  // namespace robot_client
}  // namespace rc10
