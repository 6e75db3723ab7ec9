#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace rc10::web {

static_assert(std::endian::native == std::endian::little, "a frame is written as memory is");

// All binary frames to a page begin with a header: this version u8, the kind u8, and what the kind has.
inline constexpr std::uint8_t kFrameVersion = 1;
inline constexpr std::size_t kFrameHeaderBytes = 32;

enum class FrameKind : std::uint8_t {
  kNext = 1,       ///< The columns after those of the frame before: columnsFrame().
  kReset = 2,      ///< The first of a view: what was drawn before is void.
  kRange = 3,      ///< An answer to a question about the past.
  kRecording = 4,  ///< Bytes of a recording: pieceFrame().
  kCurve = 5,      ///< Ticks of a test of motion: curveFrame().
};

/// Bytes of a binary frame to a page, number by number.
class FrameWriter {
 public:
  explicit FrameWriter(std::size_t size) { bytes_.reserve(size); }
  template <typename Number>
  void add(Number number) {
    const auto at = bytes_.size();
    bytes_.resize(at + sizeof number);
    std::memcpy(bytes_.data() + at, &number, sizeof number);
  }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace rc10::web
