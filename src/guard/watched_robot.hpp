#pragma once

#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "guard/bus_rest.hpp"
#include "guard/standstill.hpp"
#include "link/descriptor_message.hpp"
#include "link/guard_page.hpp"

namespace rc10::guard {

/// One rc10d that is watched, and the rest frames of its drives.
class WatchedRobot {
 public:
  /// From the hello of rc10d. The error says why it cannot be watched.
  [[nodiscard]] static Result<WatchedRobot> from(link::DescriptorMessage message);
  /// The connection stays open as long as rc10d is watched: by its end rc10d knows that nobody does.
  void keep(UniqueFd connection) noexcept { connection_ = std::move(connection); }

  /// Once per wake-up, and when rc10d has died: `ended`, its deathDescriptor() is readable. Returns what to
  /// tell, empty for nothing.
  [[nodiscard]] std::string step(bool ended);
  /// There is nothing left to do for it.
  [[nodiscard]] bool over() const noexcept { return over_; }
  /// It sends rest frames, or has.
  [[nodiscard]] bool rests() const noexcept { return resting_; }

  [[nodiscard]] const std::string& robot() const noexcept { return robot_; }
  /// It has commanded drives.
  [[nodiscard]] bool ticks() const noexcept { return page_->ticks.load(std::memory_order_relaxed) > 0; }
  /// Leaves the drives that another rc10d commands now to that.
  void handOver(const WatchedRobot& to);
  /// Readable when rc10d has died; -1 once that is known.
  [[nodiscard]] int deathDescriptor() const noexcept { return dead_ ? -1 : process_.get(); }

 private:
  WatchedRobot(std::string robot, std::uint32_t standstill_ms, link::SharedGuardPage page, UniqueFd process,
               std::vector<BusRest> buses);
  [[nodiscard]] std::string begin(const std::string& why);
  [[nodiscard]] std::string send();

  // A bus without power gives no echo; nor does it move a motor.
  static constexpr int kLongestRestSteps = 600 * 1000 / static_cast<int>(Standstill::kStepMs);

  std::string robot_;
  Standstill standstill_;
  link::SharedGuardPage page_;
  UniqueFd process_;
  UniqueFd connection_;
  std::vector<BusRest> buses_;
  bool dead_ = false;
  bool resting_ = false;
  bool rested_ = false;
  bool over_ = false;
  int rest_steps_ = 0;
};

}  // namespace rc10::guard
