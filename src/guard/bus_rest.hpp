#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "bus/can_frame.hpp"

namespace rc10::guard {

/// The rest frames of one interface, sent until the bus has carried them. Never waits: who calls step() does.
class BusRest {
 public:
  /// Copies of every frame on the bus: one may meet a drive that just resets.
  static constexpr std::size_t kRounds = 3;

  BusRest(std::string interface, std::vector<CanFrame> frames);

  /// Opens the interface, which then costs nothing until begin(). The error names the interface.
  [[nodiscard]] Result<void> open();
  /// The next steps send.
  void begin();
  /// Leaves the frames of the other's ids to that: its rc10d commands those drives. False: none of ours is
  /// left.
  [[nodiscard]] bool leaveTo(const BusRest& other);
  /// Sends a round of frames, if the interface takes them, and opens it anew where it has gone.
  void step();
  /// As many echoes as kRounds of all frames have been heard.
  [[nodiscard]] bool done() const noexcept { return echoes_ >= kRounds * frames_.size(); }

  [[nodiscard]] const std::string& interface() const noexcept { return interface_; }

 private:
  // Between two tries to open an interface that has gone.
  static constexpr int kReopenSteps = 20;

  void hear();
  void listen();

  std::string interface_;
  std::vector<CanFrame> frames_;
  UniqueFd socket_;
  std::size_t next_ = 0;
  std::size_t echoes_ = 0;
  int reopen_in_ = 0;
};

}  // namespace rc10::guard
