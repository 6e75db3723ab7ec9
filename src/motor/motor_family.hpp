#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "app/result.hpp"
#include "bus/fdcan_bus.hpp"
#include "bus/frame_bits.hpp"
#include "motor/drive_setup.hpp"
#include "motor/motor_base.hpp"
#include "motor/motor_settings.hpp"
#include "motor/own_key.hpp"

namespace rc10 {

/// Data of one model for configuration, guards and simulation. Torque and speed at the output shaft of the
/// model's own gear.
struct MotorTraits {
  int min_id = 1;
  int max_id = 127;
  double gear_ratio = 1.0;                    ///< Gear ratio of the model itself.
  CommandUnit effort = CommandUnit::kAmpere;  ///< Unit of effort_limit: A or V.
  float effort_full_scale = 0.0F;             ///< The largest effort that the drive can be told.
  float torque_nm_per_a = 0.0F;               ///< 0: unknown.
  float no_load_rpm = 0.0F;                   ///< At its nominal voltage; 0: unknown.
  float nominal_v = 24.0F;
  float rotor_inertia_kg_m2 = 0.0F;   ///< Inertia of the rotor itself; 0: unknown.
  float phase_resistance_ohm = 0.0F;  ///< 0: unknown.
  bool absolute = false;              ///< Knows its output angle at power-up, behind its own gear.
  bool reports_temperature = true;
  bool scaled_speed = false;  ///< Its speed is a share of a range that depends on the model.
  float frozen_a = 0.0F;      ///< Full scale of the current that it reports; 0: it reports none.
  float signed_a = 0.0F;      ///< Full scale of a current with the sign of the torque; 0: it reports none.
  int signed_current_hz = 0;  ///< Rate at which it reports that; 0: with each feedback.
  int feedback_hz = 1000;     ///< If nobody says otherwise.
  int min_feedback_hz = 1;
  int max_feedback_hz = 1000;
  bool asked = false;        ///< Speaks only when told something: its feedback comes at the command rate.
  bool fd = false;           ///< Speaks CAN FD.
  bool classic_only = true;  ///< An FD frame on its bus is an error to it.
  bool watchdog = false;  ///< Stops by itself when commands stay away: its own, set or verified by enabling.
  ModeSet modes;
  DriveFrames frames;
  const CascadeConfig* host_loops = nullptr;  ///< Defaults of its loops on the host; null: it has none.
  bool own_velocity_loop = false;             ///< The angle loop alone of host_loops acts.
  const DriveSetup* setup = nullptr;          ///< Settings that can be written; null: none.
};

/// Frames of a drive on its bus, for the check of ids and load before power-on.
struct BusUse {
  struct Stream {
    CanId id;
    FrameShape shape;
    double per_second = 0.0;
  };
  std::vector<FrameFilter> sends;  ///< Every frame that the drive may send.
  std::vector<FrameFilter> obeys;  ///< Every frame that it takes as meant for it.
  /// Those of them that move, brake, enable or stop it: another sender of these commands our drive.
  /// Empty: all. Questions and settings are none.
  std::vector<FrameFilter> steers;
  std::vector<Stream> feedback;  ///< Its usual traffic while it is enabled.
  std::vector<Stream> commands;
  /// Drives with the same layout may share command frames (four DJI currents in one); empty: shares none.
  std::string_view layout{};
};

/// The bus on which a family builds its motors, and the packers that several of them share.
class BusParts {
 public:
  explicit BusParts(fdCANbus& bus) noexcept : bus_(bus) {}

  [[nodiscard]] fdCANbus& bus() noexcept { return bus_; }
  /// The shared packer that sends this id, if it is a Group.
  template <typename Group>
  [[nodiscard]] Group* find(CanId command_id) const noexcept {
    for (const auto& packer : owned_) {
      const auto ids = packer->commandIds();
      if (ids.front() == command_id) return dynamic_cast<Group*>(packer.get());
    }
    return nullptr;
  }
  /// Registers a packer with the bus and keeps it.
  [[nodiscard]] Result<void> add(std::unique_ptr<CommandPacker> packer);

 private:
  fdCANbus& bus_;
  std::vector<std::unique_ptr<CommandPacker>> owned_;
};

/// One family of drives: all that the rest of the program needs to know of it. Stateless, and constant
/// after start. Start-up only: it allocates.
class MotorFamily {
 public:
  MotorFamily() = default;
  MotorFamily(const MotorFamily&) = delete;
  MotorFamily& operator=(const MotorFamily&) = delete;
  virtual ~MotorFamily() = default;

  /// "DJI", for messages and docs.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// As written in the configuration; no two families share one.
  [[nodiscard]] virtual std::span<const std::string_view> models() const noexcept = 0;
  [[nodiscard]] virtual std::span<const OwnKey> keys() const noexcept { return {}; }
  /// `model` is one of models(); `own` has all of keys().
  [[nodiscard]] virtual MotorTraits traits(std::string_view model, const OwnValues& own) const = 0;
  /// Conditions beyond the ranges of single keys. The error begins with the key: "master_id: ...".
  [[nodiscard]] virtual Result<void> check(const MotorSettings& settings) const;
  /// `settings` has passed check().
  [[nodiscard]] virtual BusUse busUse(const MotorSettings& settings) const = 0;
  /// Builds the motor and registers its halves with the bus. The error names the motor.
  [[nodiscard]] virtual Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                                  BusParts& parts) const = 0;
};

}  // namespace rc10
