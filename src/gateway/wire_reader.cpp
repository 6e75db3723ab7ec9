#include "gateway/wire_reader.hpp"

#include <limits>

namespace rc10::gateway {

const char* inWords(Defect defect) noexcept {
  switch (defect) {
    case Defect::kNone: return "is well-formed";
    case Defect::kTooLarge: return "is larger than any valid one";
    case Defect::kTruncated: return "is truncated";
    case Defect::kOtherDefinitions: return "uses other definitions";
    case Defect::kBadText: return "has a string that is not terminated properly";
    case Defect::kTextTooLong: return "has a name or text that is too long";
    case Defect::kBadCount: return "has a negative number of elements";
    case Defect::kTooMany: return "has too many elements";
    case Defect::kTrailingBytes: return "has bytes after its end";
  }
  return "is not understood";
}

std::uint64_t WireReader::bigEndian(std::size_t size) noexcept {
  if (rest_.size() < size) {
    spoil(Defect::kTruncated);
    return 0;
  }
  std::uint64_t value = 0;
  for (const std::byte byte : rest_.first(size)) value = (value << 8U) | std::to_integer<std::uint64_t>(byte);
  rest_ = rest_.subspan(size);
  return value;
}

std::string_view WireReader::text(std::size_t max_size) noexcept {
  const auto size = number<std::uint32_t>();  // with the final 0; a negative one is a huge one
  if (defect_ != Defect::kNone) return {};
  if (size > rest_.size()) {
    spoil(size > std::uint32_t{std::numeric_limits<std::int32_t>::max()} ? Defect::kBadText
                                                                         : Defect::kTruncated);
    return {};
  }
  const std::string_view all{reinterpret_cast<const char*>(rest_.data()), size};
  if (size == 0 || all.find('\0') != size - 1) {
    spoil(Defect::kBadText);
    return {};
  }
  rest_ = rest_.subspan(size);
  if (size - 1 > max_size) {
    spoil(Defect::kTextTooLong);
    return {};
  }
  return all.substr(0, size - 1);
}

std::string_view WireReader::anyText() noexcept {
  const auto size = number<std::uint32_t>();
  if (size > rest_.size()) spoil(Defect::kTruncated);
  if (defect_ != Defect::kNone) return {};
  const std::string_view all{reinterpret_cast<const char*>(rest_.data()), size};
  rest_ = rest_.subspan(size);
  return all.substr(0, all.find('\0'));
}

std::uint32_t WireReader::count(std::uint32_t max) noexcept {
  const auto value = number<std::int32_t>();
  if (value < 0) spoil(Defect::kBadCount);
  if (value > 0 && static_cast<std::uint32_t>(value) > max) spoil(Defect::kTooMany);
  return defect_ == Defect::kNone ? static_cast<std::uint32_t>(value) : 0;
}

}  // namespace rc10::gateway
