#pragma once

#include <string_view>
#include <vector>

#include "bus/can_frame.hpp"

namespace rc10 {

/// Possible sender of a frame.
struct DriveGuess {
  std::string_view kind;   ///< "VESC", "DJI GM6020"
  int id = 0;              ///< The drive's, as in the configuration.
  bool from_drive = true;  ///< Else another controller commands such drives; `id` is 0 if it means several.
  friend bool operator==(const DriveGuess&, const DriveGuess&) = default;
};

/// Adds all that a data frame may be of one family: by id, length, and what its bytes allow.
using Recogniser = void (*)(const CanFrame& frame, std::vector<DriveGuess>& guesses);

/// Kinds that more than one file names.
namespace drive_kind {
inline constexpr std::string_view kVesc = "VESC";
inline constexpr std::string_view kOdrive = "ODrive";
/// `is_extended` is set in the drive: the same messages under ids of 29 bits. rc10d does not drive it so.
inline constexpr std::string_view kOdriveExtended = "ODrive (extended ids)";
inline constexpr std::string_view kLktech = "LK-Tech";
inline constexpr std::string_view kMyactuator = "MyActuator";
}  // namespace drive_kind

}  // namespace rc10
