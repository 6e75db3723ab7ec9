#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "blackbox/image.hpp"

namespace rc10::web {

struct RecordingFile {
  std::string name;
  std::int64_t changed_us = 0;  ///< Since 1970.
  bool live = false;            ///< In the run folder: rc10d is writing it, or wrote it last.
};

/// A recording on its way to a page.
struct OpenRecording {
  UniqueFd fd;
  blackbox::ImageReader reader;
};

/// The recordings of this computer: those of the run folder, and the copies. A name chooses among them and
/// reaches no other file.
class Recordings {
 public:
  static constexpr std::size_t kMost = 64;

  Recordings(std::string run_dir, std::string state_dir);

  /// Live ones first, then the newest.
  [[nodiscard]] std::vector<RecordingFile> list() const;
  /// The error names the file and what is wrong.
  [[nodiscard]] Result<OpenRecording> open(std::string_view name) const;

 private:
  std::string run_dir_;
  std::string state_dir_;
};

/// Binary frame to a page with the next piece of a recording, little-endian: version u8 and kind u8 as in
/// columnsFrame(), 0 u16, bytes u32, number of the question u32, 0 u32, offset in the file f64, bytes of the
/// file f64; then the bytes. Offset 0 comes last. The error is a sentence.
[[nodiscard]] Result<std::vector<std::byte>> pieceFrame(blackbox::ImageReader& reader, std::uint32_t number,
                                                        bool& last);

}  // namespace rc10::web
