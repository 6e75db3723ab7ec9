#include "survey/harmless_queries.hpp"

#include <array>

#include "drives/robstride/robstride_frames.hpp"
#include "drives/vesc/vesc_frames.hpp"

namespace rc10::survey {
namespace {

// Who asks. These numbers are part of the safety: see the header.
constexpr std::uint8_t kVescHost = 0xFE;
constexpr std::uint32_t kRobStrideHost = 0xFD;
constexpr int kVescIds = 254;  // 254 is ours, 255 all of them
constexpr int kRobStrideIds = 127;

}  // namespace

std::vector<CanFrame> harmlessQueries() {
  std::vector<CanFrame> queries;
  queries.reserve(std::size_t{kVescIds} + std::size_t{kRobStrideIds});
  const std::array<std::uint8_t, 1> who{kVescHost};
  for (int id = 0; id < kVescIds; ++id)
    queries.push_back(makeClassicFrame(vescId(VescPacket::kPing, id), who));
  const std::array<std::uint8_t, 8> nothing{};
  for (int id = 1; id <= kRobStrideIds; ++id)
    queries.push_back(makeClassicFrame(robStrideId(RobStrideType::kGetId, kRobStrideHost, id), nothing));
  return queries;
}

}  // namespace rc10::survey
