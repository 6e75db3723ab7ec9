#pragma once

#include <cstdint>
#include <memory>

#include "drives/lktech/lktech_frames.hpp"
#include "sim/servo_drive.hpp"

namespace rc10::sim {

/// A simulated LK-Tech drive: what CAN protocol V2.35 says of it, with the firmware that honours the bound of
/// the current in speed commands.
class LktechDrive final : public ServoDrive {
 public:
  LktechDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load);

  void receive(const CanFrame& frame) noexcept override;
  void restart() noexcept override;
  /// Bits of the error byte: they stay until cleared after their cause is gone.
  void fault(std::uint32_t native_code) noexcept override;

 private:
  void obey(const CanFrame& frame) noexcept;
  void answerReading(lktech::Code code) noexcept;
  void answerStatus(lktech::Code code) noexcept;
  [[nodiscard]] CanFrame reply(lktech::Code code) const noexcept;
  [[nodiscard]] bool able() const noexcept { return on_ && errors_ == 0; }
  void forgetTurns() noexcept;

  int id_;
  double amperes_per_raw_ = 1.0;
  std::uint32_t encoder_counts_;
  bool on_ = true;
  Duration boots_until_{};
  std::uint8_t cause_ = 0;
  std::uint8_t errors_ = 0;
};

[[nodiscard]] std::unique_ptr<Drive> makeLktechDrive(const MotorSettings& settings, const MotorLoad& load);

}  // namespace rc10::sim
