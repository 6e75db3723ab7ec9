#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "bus/can_frame.hpp"

namespace rc10 {

/// A data frame as can-utils' cansend takes it: "200#0000000000000000", extended ids with 8 digits
/// "00000901#", FD "123##1AABB" with the flags (1: bit rate switch) in the first digit. Allocates.
[[nodiscard]] std::string frameText(const CanFrame& frame);

/// An id for messages: "0x1FF", or "0x00000901 (extended)". Allocates.
[[nodiscard]] std::string idText(CanId id);

/// The other way round of frameText(). The error says what is wrong with the text.
[[nodiscard]] Result<CanFrame> parseFrameText(std::string_view text);

/// A frame and where it is to go.
struct AddressedFrame {
  std::string interface;
  CanFrame frame;
};

/// A line for each frame: interface, space, frameText().
[[nodiscard]] std::string frameListText(const std::vector<AddressedFrame>& frames);

/// The other way round. Empty lines and lines that begin with '#' say nothing; everything else must be a
/// frame, or the error names the line.
[[nodiscard]] Result<std::vector<AddressedFrame>> parseFrameList(std::string_view text);

}  // namespace rc10
