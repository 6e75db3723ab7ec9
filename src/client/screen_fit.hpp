#pragma once

#include <cstddef>
#include <string>

namespace rc10::client {

/// Size of a terminal. 0: not known, no bound.
struct ScreenSize {
  std::size_t columns = 0;
  std::size_t rows = 0;
  friend bool operator==(const ScreenSize&, const ScreenSize&) = default;
};

/// Whole lines, some of which may be left out.
struct Picture {
  std::string text;
  std::size_t motors = 0;  ///< Lines at the end of `text` that are motors, one each.
  std::string modules;     ///< Lines that are left out first.
  std::string below;
};

/// The picture where nothing wraps and nothing scrolls: what is beyond the last column is cut off, colours
/// excepted, and a line tells how many motors there is no room for. The last column and the last row stay
/// free: a full line there would lose its last character to the clearing of the rest, or scroll.
[[nodiscard]] std::string fitted(const Picture& picture, ScreenSize size);

}  // namespace rc10::client
