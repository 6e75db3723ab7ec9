#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "drives/myactuator/myactuator_frames.hpp"
#include "sim/servo_drive.hpp"

namespace rc10::sim {

/// A simulated RMD-X drive: what Motion Protocol V4.2 says of it, and what others measured of its protection
/// against silence (see myactuator_frames.hpp).
class MyactuatorDrive final : public ServoDrive {
 public:
  MyactuatorDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load);

  void receive(const CanFrame& frame) noexcept override;
  void step(Duration dt) noexcept override;
  void restart() noexcept override;
  /// Bits of the error word. Those of "level 1" stay until a restart, the others while their cause does.
  void fault(std::uint32_t native_code) noexcept override;

  /// As set with 0xB3; 0: off. rc10d sets it by request only.
  void setSilenceLimit(Duration limit) noexcept { silence_limit_ = limit; }

 private:
  void obey(const CanFrame& frame) noexcept;
  void obeyMotion(const CanFrame& frame) noexcept;
  void set(const CanFrame& frame) noexcept;
  void answerReading(myactuator::Code code) noexcept;
  void answerMotion() noexcept;
  void answerStatus() noexcept;
  [[nodiscard]] CanFrame reply(myactuator::Code code) const noexcept;
  [[nodiscard]] bool booting() const noexcept { return elapsed() < boots_until_; }

  int id_;
  std::array<std::uint32_t, 4> accelerations_{1000, 1000, 1000, 1000};  ///< deg/s^2
  Duration started_{};
  Duration boots_until_{};
  Duration heard_{};
  Duration silence_limit_{};
  Duration next_notice_{};
  bool silence_stopped_ = false;
  bool brake_released_ = false;
  std::uint16_t cause_ = 0;
  std::uint16_t errors_ = 0;
};

[[nodiscard]] std::unique_ptr<Drive> makeMyactuatorDrive(const MotorSettings& settings,
                                                         const MotorLoad& load);

}  // namespace rc10::sim
