#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "drives/damiao/damiao_family.hpp"
#include "drives/damiao/damiao_frames.hpp"
#include "drives/damiao/damiao_model.hpp"
#include "sim/servo_drive.hpp"

namespace rc10::sim {

/// A Damiao drive: registers, control modes, watchdog and faults as the manual says, and as its firmware was
/// seen to behave (analysis: umeow0716/damiao_firmware): it takes every frame whose low byte is its id,
/// answers each with its state, keeps a target that came while disabled, and wraps fields that do not fit.
class DamiaoDrive : public ServoDrive {
 public:
  DamiaoDrive(const MotorSettings& settings, const MotorLoad& load);

  void receive(const CanFrame& frame) noexcept override;
  void step(Duration dt) noexcept override;
  void restart() noexcept override;
  void fault(std::uint32_t native_code) noexcept override;

 private:
  static constexpr std::size_t kOthers = 7;
  /// Registers with a copy in flash: a restart restores the copy.
  struct Registers {
    std::uint32_t timeout = 0;
    std::uint32_t control = 1;
    DamiaoScale scale;
    int id = 0;
    std::uint32_t master_id = 0;
    std::array<std::uint32_t, kOthers> others{};  ///< Those that do nothing here: see otherIndex().
  };
  /// A target, kept until it is told another or disabled.
  struct Setpoint {
    DamiaoControl control = DamiaoControl::kMit;
    SpringLaw mit;
    double position_rad = 0.0;
    double velocity_rad_s = 0.0;
    double current_pu = 0.0;
  };

  void receiveRegister(std::span<const std::uint8_t, 8> payload) noexcept;
  [[nodiscard]] bool write(std::uint8_t address, std::uint32_t value) noexcept;
  [[nodiscard]] bool receiveSpecial(std::span<const std::uint8_t, 8> payload) noexcept;
  void receiveSetpoint(std::uint32_t family, const CanFrame& frame) noexcept;
  void disarm() noexcept;
  void follow() noexcept;
  void sendState() noexcept;
  void send(const damiao::Payload& payload) noexcept;
  void rebase() noexcept;
  [[nodiscard]] double positionRad() const noexcept;

  int id_;  ///< In force: a new one from the next restart on.
  DamiaoSettings own_;
  Registers saved_;
  Registers registers_;
  Setpoint setpoint_;
  bool armed_ = false;
  std::uint8_t fault_ = 0;
  Duration heard_{};  ///< When a control frame came last.
};

[[nodiscard]] std::unique_ptr<Drive> makeDamiaoDrive(const MotorSettings& settings, const MotorLoad& load);

}  // namespace rc10::sim
