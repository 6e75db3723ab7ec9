#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "app/result.hpp"
#include "app/time.hpp"
#include "bus/can_frame.hpp"
#include "drives/dji/dji_model.hpp"
#include "motor/motor_settings.hpp"
#include "sim/drive.hpp"
#include "sim/motor_physics.hpp"
#include "sim/sim_config.hpp"

namespace rc10::sim {

/// One drive to simulate: as it is set on the drive itself, and what it turns.
struct DjiDriveConfig {
  std::string name;
  const DjiModel* model = nullptr;
  int id = 0;
  DjiCommand command = DjiCommand::kCurrent;
  double gear_ratio = 0.0;  ///< 0: the model's own.
  MotorLoad load;
};

/// A DJI drive with its motor: takes the real command frames and gives the real feedback frames.
///
/// It keeps obeying the last command when commands stop: the manuals (C620 V1.01, C610, GM6020 v1.2) know no
/// watchdog, and the daemon must be safe with the worse of the two possibilities.
class DjiDrive : public Drive {
 public:
  /// The error names the drive, the field and the allowed range.
  [[nodiscard]] static Result<void> check(const DjiDriveConfig& config);

  /// `config` has passed check().
  explicit DjiDrive(const DjiDriveConfig& config);

  /// Takes its slot of a command frame; anything else is not for this drive.
  void receive(const CanFrame& frame) noexcept override;
  void step(Duration dt) noexcept override;
  [[nodiscard]] Duration feedbackPeriod() const noexcept override { return std::chrono::milliseconds{1}; }
  [[nodiscard]] std::size_t feedback(std::span<CanFrame> out) noexcept override;
  /// The feedback at this moment.
  [[nodiscard]] CanFrame feedbackFrame() const noexcept;
  void setEncoderFault(const EncoderFault& fault) noexcept override;
  void setLoad(const MotorLoad& load) noexcept override;

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] std::span<const FrameFilter> sends() const noexcept override { return sends_; }
  [[nodiscard]] const MotorLoad& load() const noexcept override { return load_; }
  [[nodiscard]] MotorPhysics& physics() noexcept override { return physics_; }
  [[nodiscard]] const MotorPhysics& physics() const noexcept override { return physics_; }
  /// The command in force, as it was sent.
  [[nodiscard]] std::int16_t rawCommand() const noexcept { return raw_command_; }
  [[nodiscard]] CanId commandId() const noexcept;
  [[nodiscard]] CanId feedbackId() const noexcept;

 private:
  std::string name_;
  const DjiModel* model_;
  int id_;
  DjiCommand command_;
  double gear_ratio_;
  std::array<FrameFilter, 1> sends_;
  MotorLoad load_;
  EncoderFault encoder_fault_;
  CanFrame frozen_{};
  MotorPhysics physics_;
  std::int16_t raw_command_ = 0;
  WindingCommand winding_;
};

/// The simulated drive of a configured DJI motor.
[[nodiscard]] std::unique_ptr<Drive> makeDjiDrive(const MotorSettings& settings, const MotorLoad& load);

/// For SimBusConfig: a DJI drive, checked when it is made.
[[nodiscard]] std::function<Result<std::unique_ptr<Drive>>()> djiDrive(DjiDriveConfig config);

}  // namespace rc10::sim
