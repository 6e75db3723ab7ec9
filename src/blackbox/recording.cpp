#include "blackbox/recording.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "blackbox/image.hpp"

namespace rc10::blackbox {
namespace {

template <typename T>
[[nodiscard]] T take(std::span<const std::byte> bytes) noexcept {
  T record;  // fields beyond a shorter record are zero
  std::memcpy(&record, bytes.data(), std::min(sizeof record, bytes.size()));
  return record;
}

[[nodiscard]] bool isKnown(RecordType type) noexcept {
  return type >= RecordType::kFrame && type <= RecordType::kSignals;
}

// Appends [from, to) of a stream that lies in a ring.
void unroll(std::span<const std::byte> ring, std::uint64_t from, std::uint64_t to,
            std::vector<std::byte>& out) {
  while (from < to) {
    const std::uint64_t at = from % ring.size();
    const std::uint64_t bytes = std::min(to - from, ring.size() - at);
    const auto piece = ring.subspan(at, bytes);
    out.insert(out.end(), piece.begin(), piece.end());
    from += bytes;
  }
}

}  // namespace

const RecordHeader& headerOf(const Record& record) {
  return *std::visit([](const auto& r) { return &r.header; }, record);
}

Result<Recording> Recording::parse(std::span<const std::byte> image) {
  Recording recording;
  auto& head = recording.head_;
  if (image.size() < sizeof head) return fail("this is no black box of rc10d");
  std::memcpy(&head, image.data(), sizeof head);
  const auto& header = head.header;
  if (auto checked = checkHeader(header); !checked) return tl::unexpected(checked.error());
  if (image.size() < header.file_bytes) {
    return fail("it is cut off: it has " + std::to_string(image.size()) + " of " +
                std::to_string(header.file_bytes) + " bytes");
  }
  const auto& control = head.control;
  // A history that could not be written is given up: then `oldest` is ahead of `tail`.
  const std::uint64_t handed_over = std::max(control.oldest, control.tail);
  const bool fits = control.tail <= control.head && control.head - control.tail <= header.ring_bytes &&
                    control.oldest <= control.head &&
                    (control.oldest >= control.tail || control.tail - control.oldest <= header.history_bytes);
  if (!fits) return fail("it is damaged: its positions contradict each other");
  recording.stream_.reserve(control.head - control.oldest);
  unroll(image.subspan(header.history_offset, header.history_bytes), control.oldest, control.tail,
         recording.stream_);
  unroll(image.subspan(header.ring_offset, header.ring_bytes), handed_over, control.head, recording.stream_);
  recording.index();
  return recording;
}

void Recording::index() {
  const std::uint64_t size = stream_.size();
  std::uint64_t at = 0;
  while (size - at >= sizeof(RecordHeader)) {
    const auto header = take<RecordHeader>(std::span(stream_).subspan(at));
    const std::uint64_t bytes = header.words * kWord;
    if (bytes < sizeof header || bytes > size - at) break;
    // Types of a later version are passed over.
    if (isKnown(header.type)) entries_.push_back({header.time_ns, at});
    at += bytes;
  }
  damaged_bytes_ = size - at;
  // Frames have the time at which the kernel got them, which is before their tick's.
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.time_ns < b.time_ns; });
}

Record Recording::at(std::size_t index) const noexcept {
  const auto rest = std::span(stream_).subspan(entries_[index].offset);
  const auto header = take<RecordHeader>(rest);
  const auto bytes = rest.first(header.words * kWord);
  switch (header.type) {
    case RecordType::kFrame: return take<Frame>(bytes);
    case RecordType::kCommand: return take<Command>(bytes);
    case RecordType::kSetpoint: return take<Setpoint>(bytes);
    case RecordType::kOrder: return take<Order>(bytes);
    case RecordType::kEvent: return take<Event>(bytes);
    case RecordType::kMotor: return take<Motor>(bytes);
    case RecordType::kRobot: return take<Robot>(bytes);
    case RecordType::kSignals: return take<Signals>(bytes);
    case RecordType::kBus: break;
  }
  return take<Bus>(bytes);
}

std::int64_t Recording::wallUs(std::int64_t mono_ns) const noexcept {
  // Unsigned: a damaged time must not overflow.
  const auto sum = static_cast<std::uint64_t>(mono_ns) + static_cast<std::uint64_t>(control().wall_offset_ns);
  return static_cast<std::int64_t>(sum) / 1000;
}

std::string_view Recording::motorName(std::size_t index) const noexcept {
  return index < header().motor_count ? header().motors[index].name.view() : "?";
}

std::string_view Recording::busName(std::size_t index) const noexcept {
  return index < header().bus_count ? header().buses[index].name.view() : "?";
}

std::string_view Recording::moduleName(std::size_t index) const noexcept {
  return index < header().module_count ? header().modules[index].name.view() : "?";
}

std::string_view Recording::inputName(std::size_t module, std::size_t input) const noexcept {
  if (module >= header().module_count) return "?";
  const auto& info = header().modules[module];
  return input < std::min<std::size_t>(info.input_count, info.inputs.size()) ? info.inputs[input].view()
                                                                             : "?";
}

std::string_view Recording::moduleEvent(std::size_t module, std::int32_t event) const noexcept {
  if (module >= header().module_count || event < 0) return {};
  const auto& info = header().modules[module];
  const auto known = std::min<std::size_t>(info.event_count, info.events.size());
  const auto place = static_cast<std::size_t>(event);
  return place < known ? info.events[place].view() : std::string_view{};
}

bool Recording::simulated() const noexcept {
  const auto buses = std::span{header().buses}.first(header().bus_count);
  return std::any_of(buses.begin(), buses.end(),
                     [](const BusInfo& bus) { return bus.interface.view().empty(); });
}

std::string_view Recording::sourceName(const Event& event) const noexcept {
  if (event.header.source == kNoSource) return "robot";
  if (event.header.id >= kFirstModuleEvent && event.header.id <= kLastModuleEvent) {
    return moduleName(event.header.source);
  }
  return event.header.id >= kFirstBusEvent ? busName(event.header.source) : motorName(event.header.source);
}

std::string_view Recording::interfaceName(std::size_t index) const noexcept {
  if (index >= header().bus_count) return "?";
  const auto interface = header().buses[index].interface.view();
  return interface.empty() ? busName(index) : interface;
}

}  // namespace rc10::blackbox
