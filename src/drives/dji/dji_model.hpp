#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "bus/can_frame.hpp"
#include "motor/cascade.hpp"
#include "motor/drive_frames.hpp"
#include "motor/encoder.hpp"
#include "motor/own_values.hpp"

namespace rc10 {

/// Command to the drive: the current (torque) or the voltage of the winding.
enum class DjiCommand : std::uint8_t { kCurrent, kVoltage };

/// Settings of one motor, from its own keys.
struct DjiSettings {
  DjiCommand command = DjiCommand::kCurrent;
};
[[nodiscard]] DjiSettings djiSettings(const OwnValues& own);

/// One way to command a model: which ids carry it and how a value is written.
struct DjiCommandTable {
  std::array<std::uint16_t, 2> command_ids{};  ///< For drive ids 1-4 and 5-8; 0: none.
  float full_scale = 0.0F;                     ///< A or V at raw_full_scale.
  std::int16_t raw_full_scale = 0;
  CascadeConfig default_loops;

  [[nodiscard]] constexpr bool exists() const noexcept { return raw_full_scale != 0; }
};

/// Everything in which one DJI model differs from another.
struct DjiModel {
  std::string_view name;
  double gear_ratio = 1.0;
  std::uint16_t feedback_id_base = 0x200;  ///< Feedback id = base + drive id.
  std::uint8_t max_id = 8;
  float rotor_torque_nm_per_a = 0.0F;  ///< At the rotor; times gear ratio at the output.
  float feedback_full_scale_a = 0.0F;  ///< A at feedback_raw_full_scale.
  std::int16_t feedback_raw_full_scale = 0;
  bool reports_temperature = true;
  bool absolute_output = false;  ///< The encoder sits on the output shaft: angle known at power-up.
  float no_load_rpm = 0.0F;      ///< Output shaft, at 24 V.
  Encoder::Config encoder;
  int countable_lost_frames = 0;  ///< 1 kHz frames in a row that may be lost without a lost turn.
  DjiCommandTable current;
  DjiCommandTable voltage;

  [[nodiscard]] constexpr const DjiCommandTable& command(DjiCommand command) const noexcept {
    return command == DjiCommand::kCurrent ? current : voltage;
  }
};

/// Frames of all models: everything but rest is computed by the host's loops.
inline constexpr DriveFrames kDjiFrames{.rest = Provision::kFrame,
                                        .poll = Provision::kNothing,
                                        .idle = Provision::kFrame,
                                        .damp = Provision::kHostLoop,
                                        .brake = Provision::kHostLoop,
                                        .hold = Provision::kHostLoop,
                                        .enable = Provision::kNothing,
                                        .disable = Provision::kNothing};

/// The table of models. Sources stand beside each figure in dji_model.cpp.
extern const DjiModel kM3508;
extern const DjiModel kM2006;
extern const DjiModel kGM6020;

/// nullptr if there is no such model.
[[nodiscard]] const DjiModel* findDjiModel(std::string_view name) noexcept;

/// All models, for messages and tests.
[[nodiscard]] std::array<const DjiModel*, 3> djiModels() noexcept;

// Ids of a drive on its bus, and the place of its command in a frame of four: 0 to 3.
[[nodiscard]] CanId djiFeedbackId(const DjiModel& model, int id) noexcept;
[[nodiscard]] CanId djiCommandId(const DjiModel& model, DjiCommand command, int id) noexcept;
[[nodiscard]] constexpr int djiSlot(int id) noexcept { return (id - 1) % 4; }

}  // namespace rc10
