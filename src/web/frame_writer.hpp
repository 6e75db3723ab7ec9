#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

namespace rc10::web {

static_assert(std::endian::native == std::endian::little, "a frame is written as memory is");

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
