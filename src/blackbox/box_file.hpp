#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "blackbox/format.hpp"

namespace rc10::blackbox {

/// The file of a running rc10d. Its beginning and the hand-off ring are mapped, touched and, once the process
/// locks its memory, locked; the history is not. On a file system that is not in memory a mapped page would
/// be taken away for writing to the disk, and the scheduler thread would wait for it: there the ring is
/// private memory, and what it holds at a crash (some 20 ms) is lost.
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

  /// Writes the control words to the file where they are not mapped from it. io thread, after a drain.
  [[nodiscard]] Result<void> publish();

 private:
  BoxFile(std::string path, UniqueFd fd, FileHead* head, std::size_t mapped, bool shared) noexcept
      : path_(std::move(path)), fd_(std::move(fd)), head_(head), mapped_(mapped), shared_(shared) {}

  std::string path_;
  UniqueFd fd_;
  FileHead* head_;
  std::size_t mapped_;
  bool shared_;
};

}  // namespace rc10::blackbox
