#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bus/can_frame.hpp"

/// Which drives are on a bus, from their frames alone.
namespace rc10::survey {

inline constexpr std::string_view kVesc = "VESC";
inline constexpr std::string_view kODrive = "ODrive";
/// `is_extended` is set in the drive: the same messages under ids of 29 bits. rc10d does not drive it so.
inline constexpr std::string_view kODriveExtended = "ODrive (extended ids)";

/// What a frame may be.
struct Guess {
  std::string_view kind;   ///< "VESC", "DJI GM6020"
  int id = 0;              ///< The drive's, as in the configuration.
  bool from_drive = true;  ///< Else another controller commands such drives; `id` is 0 if it means several.
  friend bool operator==(const Guess&, const Guess&) = default;
};

/// All that this frame may be, by the tables of frames of the families: id, length, and what its bytes allow.
/// Empty: no family that rc10d knows.
[[nodiscard]] std::vector<Guess> recognise(const CanFrame& frame);

}  // namespace rc10::survey
