#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "blackbox/cut_file_guard.hpp"
#include "blackbox/format.hpp"

namespace rc10::blackbox {

/// The file of a running rc10d. Its beginning and the hand-off ring are mapped, touched and, once the process
/// locks its memory, locked; the history is not. On a file system that is not in memory a mapped page would
/// be taken away for writing to the disk, and the scheduler thread would wait for it: there the ring is
/// private memory, and what it holds at a crash (some 20 ms) is lost. Nobody who cuts the file off ends the
/// process: see CutFileGuard.
class BoxFile {
 public:
  /// Puts a new file in the place of `path`, with all the room it will ever need. `header`: who records;
  /// sizes are filled in. `bytes`: a multiple of 1 MiB.
  [[nodiscard]] static Result<std::unique_ptr<BoxFile>> create(const std::string& path, Header header,
                                                               std::uint64_t bytes);
  BoxFile(const BoxFile&) = delete;
  BoxFile& operator=(const BoxFile&) = delete;
  ~BoxFile();

  [[nodiscard]] FileHead& head() noexcept { return *head_; }
  [[nodiscard]] std::span<std::byte> ring() noexcept;
  [[nodiscard]] int descriptor() const noexcept { return fd_.get(); }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// Whether nobody has cut the file off. One that was is cut off for good: what was mapped is gone. Not for
  /// real-time threads.
  [[nodiscard]] bool whole() noexcept;

  /// Marks the file as that of a run which stopped in good order. When all other threads have ended.
  [[nodiscard]] Result<void> end();
  /// Writes the control words to the file where they are not mapped from it. io thread, after a drain.
  [[nodiscard]] Result<void> publish();

 private:
  BoxFile(std::string path, UniqueFd fd, FileHead* head, std::size_t mapped, bool shared,
          std::unique_ptr<CutFileGuard> guard) noexcept;

  std::string path_;
  UniqueFd fd_;
  FileHead* head_;
  std::size_t mapped_;
  std::uint64_t file_bytes_;  ///< As in the header, which a file that is cut off has no more.
  std::uint64_t ring_offset_;
  std::uint64_t ring_bytes_;
  bool shared_;
  std::unique_ptr<CutFileGuard> guard_;
  std::atomic<bool> cut_{false};
};

}  // namespace rc10::blackbox
