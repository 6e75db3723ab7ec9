#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "bus/can_frame.hpp"

namespace rc10 {

/// One value that a drive keeps in a memory of its own and that can be written over CAN.
struct DriveSetting {
  std::string_view name;  ///< Ends with its unit.
  double min = 0.0;
  double max = 0.0;
  bool integer = false;
  /// Afterwards the drive may answer as another one: its id, or the id of its answers.
  bool identity = false;
};

/// Settings that rc10d can write to a family's drives, and the tool for all others. A constant of the family.
struct DriveSetup {
  std::span<const DriveSetting> settings{};
  bool stores_at_once = false;  ///< There is no writing without storing.
  /// It answers the save frame as it answers others: none of those may be under way meanwhile.
  bool saves_in_silence = false;
  std::string_view tool;  ///< "VESC Tool", for people.
};

struct DriveValue {
  std::uint8_t setting = 0;  ///< Index into DriveSetup::settings.
  double value = 0.0;
};

/// Request to write to one drive.
struct DriveWrite {
  static constexpr std::size_t kMaxValues = 8;
  std::array<DriveValue, kMaxValues> values{};
  std::size_t count = 0;
  bool save = false;  ///< To flash as well, where the drive tells the two apart.
};

/// The frames with which one drive is set. Constant; it has passed DriveSetup's ranges.
class DriveCodec {
 public:
  DriveCodec() = default;
  DriveCodec(const DriveCodec&) = delete;
  DriveCodec& operator=(const DriveCodec&) = delete;
  virtual ~DriveCodec() = default;

  [[nodiscard]] virtual const DriveSetup& setup() const noexcept = 0;
  [[nodiscard]] virtual CanFrame write(const DriveValue& value) const noexcept = 0;
  /// Asks for a setting; nothing where the answer to write() tells it.
  [[nodiscard]] virtual std::optional<CanFrame> read(std::size_t setting) const noexcept = 0;
  /// Value of the setting, if the frame reports it.
  [[nodiscard]] virtual std::optional<double> reading(std::size_t setting,
                                                      const CanFrame& frame) const noexcept = 0;
  /// Stores what was written. `new_id` if the drive was given one.
  [[nodiscard]] virtual std::optional<CanFrame> save(std::optional<int> new_id) const noexcept = 0;
  /// Whether the frame says that it is stored.
  [[nodiscard]] virtual bool saysSaved(const CanFrame& frame) const noexcept = 0;
  /// The setting that is the drive's id, if it has one.
  [[nodiscard]] virtual std::optional<std::size_t> idSetting() const noexcept = 0;
};

}  // namespace rc10
