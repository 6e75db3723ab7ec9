#include "web/columns_frame.hpp"

#include <algorithm>

namespace rc10::web {

std::vector<std::byte> columnsFrame(const TraceStore& store, const View& view, FrameKind kind,
                                    std::uint32_t view_number, std::int64_t first, std::size_t count) {
  count = std::min(count, kMaxColumns);
  FrameWriter out{kFrameHeaderBytes + view.signals.size() * count * 2 * sizeof(float)};
  out.add(kFrameVersion);
  out.add(kind);
  out.add(static_cast<std::uint16_t>(view.signals.size()));
  out.add(static_cast<std::uint32_t>(count));
  out.add(view_number);
  out.add(std::uint32_t{0});
  out.add(static_cast<double>(first));
  out.add(static_cast<double>(view.column_us));
  std::vector<TraceStore::Column> columns(count);
  for (const auto& signal : view.signals) {
    store.columns(signal, view.column_us, first, columns);
    for (const auto& column : columns) out.add(column.min);
    for (const auto& column : columns) out.add(column.max);
  }
  return out.take();
}

}  // namespace rc10::web
