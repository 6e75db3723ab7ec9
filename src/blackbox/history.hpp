#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/result.hpp"
#include "blackbox/format.hpp"

namespace rc10::blackbox {

/// Moves the stream from the hand-off ring to the history in the file, over the oldest records. It writes
/// with pwrite(): what is not mapped is not locked in memory either. io thread only.
class History {
 public:
  /// `head` and `ring`: the mapped beginning of the file and its hand-off ring; `fd`: the file. All
  /// outlive this.
  History(FileHead& head, std::span<const std::byte> ring, int fd);

  /// Moves everything there is. After an error the hand-off goes on, but there is no history any more.
  [[nodiscard]] Result<void> drain();
  /// No history from now on; the hand-off goes on.
  void giveUp() noexcept { broken_ = true; }

 private:
  [[nodiscard]] Result<void> store(std::uint64_t from, std::uint64_t to);
  [[nodiscard]] Result<void> forgetBefore(std::uint64_t position);

  Control& control_;
  std::span<const std::byte> ring_;
  int fd_;
  // Own copies: what is mapped is gone when somebody cuts the file off.
  std::uint64_t offset_;
  std::uint64_t room_;
  std::uint64_t tail_ = 0;
  std::uint64_t oldest_ = 0;
  std::vector<std::byte> old_;
  bool broken_ = false;
};

}  // namespace rc10::blackbox
