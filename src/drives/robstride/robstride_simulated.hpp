#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "drives/robstride/robstride_family.hpp"
#include "drives/robstride/robstride_frames.hpp"
#include "drives/robstride/robstride_model.hpp"
#include "sim/servo_drive.hpp"

namespace rc10::sim {

/// A RobStride or CyberGear drive on its private protocol. Undocumented behaviour is simulated at its worst:
/// the torque limit does not act in operation mode, and what it was told in operation mode before it was
/// stopped acts again when it is enabled.
class RobstrideDrive final : public ServoDrive {
 public:
  RobstrideDrive(const MotorSettings& settings, const MotorLoad& load);

  void receive(const CanFrame& frame) noexcept override;
  void step(Duration dt) noexcept override;
  void restart() noexcept override;
  /// The number is that of robstride::nativeCode().
  void fault(std::uint32_t native_code) noexcept override;

 private:
  struct Parameter {
    std::uint16_t index = 0;
    bool integer = false;
    double limit = 0.0;  ///< Limit of a number: +-; a limit's own number is never negative.
    std::uint32_t bits = 0;
    std::uint32_t at_power_up = 0;  ///< As stored in its flash.
  };
  static constexpr std::size_t kParameters = 13;

  [[nodiscard]] Parameter* find(std::uint16_t index) noexcept;
  [[nodiscard]] double number(std::uint16_t index) noexcept;
  void write(const CanFrame& frame) noexcept;
  void save() noexcept;
  void read(std::uint16_t index) noexcept;
  void enable() noexcept;
  void stop() noexcept;
  void follow() noexcept;
  void answerState() noexcept;
  void powerUp() noexcept;

  const RobstrideModel* model_;
  robstride::Codec codec_;
  std::array<Parameter, kParameters> parameters_;
  bool running_ = false;
  SpringLaw operation_;
  std::uint32_t fault_word_ = 0;
  std::uint8_t status_bits_ = 0;
  Duration heard_at_{};
};

[[nodiscard]] std::unique_ptr<Drive> makeRobstrideDrive(const MotorSettings& settings, const MotorLoad& load);

}  // namespace rc10::sim
