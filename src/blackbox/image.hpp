#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "blackbox/format.hpp"

namespace rc10::blackbox {

/// Where a piece of an image goes. An error ends the copy.
using Sink = std::function<Result<void>(std::uint64_t offset, std::span<const std::byte> bytes)>;

/// Whether a file can begin like this: magic, version and sizes that fit each other.
[[nodiscard]] Result<void> checkHeader(const Header& header);

/// Reads a black box piece by piece, also one that is being written, so that what was read is whole: the
/// beginning of the file comes last, and says which of the rest counts. However long it takes between two
/// pieces, what was overwritten in between is missing at the old end. Not for real-time threads.
class ImageReader {
 public:
  static constexpr std::size_t kLeastPiece = sizeof(FileHead);

  struct Piece {
    std::uint64_t offset = 0;  ///< In the file; 0: the beginning, which is the last piece.
    std::span<const std::byte> bytes;
  };

  /// `fd` outlives it.
  [[nodiscard]] static Result<ImageReader> open(int fd);

  [[nodiscard]] std::uint64_t fileBytes() const noexcept { return file_bytes_; }
  /// The next piece, in `buffer`, which has room for kLeastPiece at least. Not after the last one.
  [[nodiscard]] Result<Piece> next(std::span<std::byte> buffer);

 private:
  ImageReader(int fd, const Header& header, std::uint64_t end) noexcept;
  [[nodiscard]] Result<Piece> beginning(std::span<std::byte> buffer);

  // Not the head itself: it has 50 KiB, and threads of rc10d have little stack.
  int fd_;
  std::uint64_t history_offset_;
  std::uint64_t file_bytes_;
  std::uint64_t end_;
  std::uint64_t tail_ = 0;
  std::uint64_t at_;
};

/// All pieces, one after the other. `amend` may change the header on its way.
[[nodiscard]] Result<void> takeImage(int fd, const Sink& sink,
                                     const std::function<void(Header&)>& amend = {});

/// The whole file as one consistent image. The error names the file.
[[nodiscard]] Result<std::vector<std::byte>> readImage(const std::string& path);

}  // namespace rc10::blackbox
