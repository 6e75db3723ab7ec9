#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace rc10::ctl {

/// A QR code as lines of half blocks, light where there is ink: for a dark terminal.
struct QrPicture {
  std::size_t columns = 0;
  std::string lines;
};

/// None: it is too long for one. `coloured`: white on black whatever the terminal's colours are.
[[nodiscard]] std::optional<QrPicture> qrPicture(const std::string& text, bool coloured);

}  // namespace rc10::ctl
