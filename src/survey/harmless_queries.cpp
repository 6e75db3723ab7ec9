#include "survey/harmless_queries.hpp"

#include <array>

#include "drives/robstride/robstride_frames.hpp"
#include "drives/vesc/vesc_frames.hpp"

namespace rc10::survey {
namespace {

// Host ids of the questions. These numbers are part of the safety: see the header.
constexpr std::uint8_t kVescHost = 0xFE;
constexpr std::uint32_t kRobstrideHost = 0xFD;
constexpr int kVescIds = 254;  // 254 is ours, 255 all of them
constexpr int kRobstrideIds = 127;

}  // namespace

std::vector<CanFrame> harmlessQueries() {
  std::vector<CanFrame> queries;
  queries.reserve(std::size_t{kVescIds} + std::size_t{kRobstrideIds});
  const std::array<std::uint8_t, 1> who{kVescHost};
  for (int id = 0; id < kVescIds; ++id)
    queries.push_back(makeClassicFrame(vesc::canId(vesc::Packet::kPing, id), who));
  const std::array<std::uint8_t, 8> nothing{};
  for (int id = 1; id <= kRobstrideIds; ++id)
    queries.push_back(
        makeClassicFrame(robstride::canId(robstride::Type::kGetId, kRobstrideHost, id), nothing));
  return queries;
}

}  // namespace rc10::survey
