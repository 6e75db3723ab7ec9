#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "app/time.hpp"
#include "bus/can_frame.hpp"

namespace rc10 {

/// The sending half: turns what update() computed into frames. Never computes. Scheduler thread only.
class CommandPacker {
 public:
  CommandPacker() = default;
  CommandPacker(const CommandPacker&) = delete;
  CommandPacker& operator=(const CommandPacker&) = delete;
  virtual ~CommandPacker() = default;

  [[nodiscard]] virtual std::string_view packerName() const noexcept = 0;

  /// The ids it may send. Two packers with one id on one bus are refused at registration.
  [[nodiscard]] virtual std::span<const CanId> commandIds() const noexcept = 0;

  /// Writes this tick's frames to `out` (room for kMaxFramesPerPacker) and returns how many.
  [[nodiscard]] virtual std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept = 0;

  /// One of its frames was not sent: refused by the kernel, without room in the tick, or held back.
  virtual void onUnsent() noexcept {}

  /// The frames that leave every drive behind this packer without torque, whatever the state.
  [[nodiscard]] virtual std::size_t packRest(std::span<CanFrame> out) const noexcept = 0;
};

/// An enable sequence with several register writes fits (Damiao: clear, mode, timeout, enable).
inline constexpr std::size_t kMaxFramesPerPacker = 4;

}  // namespace rc10
