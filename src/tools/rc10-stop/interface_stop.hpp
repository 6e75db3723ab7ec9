#pragma once

#include <string>
#include <vector>

#include "app/unique_fd.hpp"
#include "bus/can_frame.hpp"

namespace rc10 {

/// Sends the rest frames of one interface a few times. Never waits: who calls step() does.
class InterfaceStop {
 public:
  /// Every frame goes out this often, kRoundSteps steps apart: one copy may meet a bus that is just full.
  static constexpr int kRounds = 3;
  static constexpr int kRoundSteps = 2;

  InterfaceStop(std::string interface, std::vector<CanFrame> frames);

  /// Sends what the interface takes now.
  void step();
  /// Everything was accepted, or the interface is beyond help.
  [[nodiscard]] bool ended() const noexcept { return !failure_.empty() || rounds_ == kRounds; }
  /// Error in words; empty: every frame was accepted.
  [[nodiscard]] std::string problem() const;

 private:
  std::string interface_;
  std::vector<CanFrame> frames_;
  UniqueFd socket_;
  std::string failure_;
  int rounds_ = 0;
  int wait_steps_ = 0;
  std::size_t next_ = 0;
};

}  // namespace rc10
