#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "link/trace_signal.hpp"
#include "web/frame_writer.hpp"
#include "web/trace_store.hpp"

namespace rc10::web {

/// Signals that a page draws, and the width of its columns.
struct View {
  std::vector<link::TraceSignal> signals;
  std::int64_t column_us = 0;  ///< 0: it draws nothing.
};

/// A screen has no more.
inline constexpr std::size_t kMaxColumns = 4096;

/// Binary frame to a page, little-endian: version u8, kind u8, signals u16, columns u32, view u32 (its
/// number, given by the page), 0 u32, first column f64, width in us f64; then for each signal the least
/// values f32 of all columns and the greatest f32. A column begins at its number times its width, in
/// CLOCK_MONOTONIC.
[[nodiscard]] std::vector<std::byte> columnsFrame(const TraceStore& store, const View& view, FrameKind kind,
                                                  std::uint32_t view_number, std::int64_t first,
                                                  std::size_t count);

}  // namespace rc10::web
