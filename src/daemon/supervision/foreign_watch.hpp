#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "bus/foreign_listener.hpp"
#include "daemon/devices/robot.hpp"

namespace rc10 {

/// Counts, for each motor, the frames with which somebody else commands its drive. Rest frames are none:
/// rc10-stop and rc10-guard send those. Scheduler thread only.
class ForeignWatch final : public ForeignListener {
 public:
  /// Listens to every bus of the robot from now on.
  explicit ForeignWatch(Robot& robot);

  void onForeign(const fdCANbus& bus, const CanFrame& frame) noexcept override;
  /// Somebody else has commanded the motor's drive too often since the last takeover().
  [[nodiscard]] bool tookOver(std::size_t motor) const noexcept {
    return watched_[motor].takeover.has_value();
  }
  /// The last of those frames, as foreignFrame() tells it; counting begins anew.
  [[nodiscard]] std::optional<std::int32_t> takeover(std::size_t motor) noexcept;

 private:
  struct Watched {
    std::array<MonotonicTime, ForeignLimit::kMost> received{};  ///< Times of the last frames, in turn.
    std::size_t count = 0;
    std::optional<std::int32_t> takeover;
  };

  void count(std::size_t motor, const ForeignLimit& limit, const CanFrame& frame) noexcept;

  const Robot& robot_;
  std::vector<Watched> watched_;
};

}  // namespace rc10
