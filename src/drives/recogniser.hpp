#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "bus/can_frame.hpp"

namespace rc10 {

/// Possible sender of a frame.
struct DriveGuess {
  std::string_view kind;   ///< "VESC", "DJI GM6020"
  int id = 0;              ///< The drive's, as in the configuration.
  bool from_drive = true;  ///< false: another controller commands such drives; `id` is 0 if it means several.
  float most_hz = 0.0F;    ///< Frames at a higher rate are of another kind; 0: they come at any rate.
  /// Advice about a drive of which nothing but such frames is heard: they answer a question. Empty: it sends
  /// them unasked.
  std::string_view silent{};
  friend bool operator==(const DriveGuess& a, const DriveGuess& b) {
    return a.kind == b.kind && a.id == b.id && a.from_drive == b.from_drive;
  }
};

/// Adds all that a data frame may be of one family: by id, length, and what its bytes allow.
using Recogniser = void (*)(const CanFrame& frame, std::vector<DriveGuess>& guesses);

/// Questions of `rc10ctl scan` that command no drive of any family: see survey/harmless_queries.hpp.
struct ScanQuestions {
  std::span<const std::string_view> asked;   ///< Drives that answer: "RobStride", "CyberGear".
  std::span<const std::string_view> silent;  ///< Those of them that may say nothing unless they are asked.
  std::vector<CanFrame> (*frames)() = nullptr;
  /// The id under which such a drive answers a question, of another family too; none: none does. Null: its
  /// answer is nobody's command.
  std::optional<CanId> (*answer)(CanId question) = nullptr;
};

/// Drive that would take a frame for a command of its own.
struct Obeying {
  DriveGuess drive;
  CanId shown;            ///< The frame by which it shows itself: as this drive.
  std::string_view name;  ///< "an ODrive with extended ids, node"; its id follows.
};

/// The drive of one family, if there is one on the bus, that would obey a question.
using ObeyedBy = std::optional<Obeying> (*)(CanId question);

/// Kinds that more than one file names.
namespace drive_kind {
inline constexpr std::string_view kVesc = "VESC";
inline constexpr std::string_view kCubemarsMit = "CubeMars (MIT)";
inline constexpr std::string_view kOdrive = "ODrive";
/// `is_extended` is set in the drive: the same messages under ids of 29 bits. rc10d does not drive it so.
inline constexpr std::string_view kOdriveExtended = "ODrive (extended ids)";
inline constexpr std::string_view kLktech = "LK-Tech";
inline constexpr std::string_view kMyactuator = "MyActuator";
}  // namespace drive_kind

}  // namespace rc10
