#include "blackbox/history.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "blackbox/file_bytes.hpp"

namespace rc10::blackbox {
namespace {

// At most so much at once: what is overwritten must be known before.
constexpr std::size_t kDrainedAtOnce = std::size_t{64} * 1024;

}  // namespace

History::History(FileHead& head, std::span<const std::byte> ring, int fd)
    : control_(head.control),
      ring_(ring),
      fd_(fd),
      offset_(head.header.history_offset),
      room_(head.header.history_bytes),
      tail_(head.control.tail),
      oldest_(head.control.oldest),
      old_(kDrainedAtOnce) {}

Result<void> History::drain() {
  const std::uint64_t end = std::atomic_ref(control_.head).load(std::memory_order_acquire);
  Result<void> outcome;
  while (tail_ < end && outcome) {
    const std::uint64_t next = broken_ ? end : std::min(end, tail_ + kDrainedAtOnce);
    if (!broken_) outcome = store(tail_, next);
    broken_ = broken_ || !outcome;
    if (broken_) std::atomic_ref(control_.oldest).store(oldest_ = next, std::memory_order_seq_cst);
    tail_ = next;
    // Release: the scheduler may write there again, and a reader that sees this finds it in the history.
    std::atomic_ref(control_.tail).store(tail_, std::memory_order_release);
  }
  return outcome;
}

Result<void> History::store(std::uint64_t from, std::uint64_t to) {
  if (to > room_) {
    if (auto forgotten = forgetBefore(to - room_); !forgotten) return forgotten;
  }
  while (from < to) {
    // Up to where either ring starts anew.
    const std::uint64_t at_ring = from & (ring_.size() - 1);
    const std::uint64_t at_history = from % room_;
    const std::uint64_t bytes = std::min({to - from, ring_.size() - at_ring, room_ - at_history});
    if (auto written = writeAll(fd_, offset_ + at_history, ring_.subspan(at_ring, bytes)); !written) {
      return written;
    }
    from += bytes;
  }
  return {};
}

// Goes from record to record, so that the oldest that is left is a whole one.
Result<void> History::forgetBefore(std::uint64_t position) {
  std::uint64_t oldest = oldest_;
  while (oldest < position) {
    const std::uint64_t at = oldest % room_;
    const std::uint64_t bytes = std::min<std::uint64_t>(
        {position - oldest + sizeof(RecordHeader), old_.size(), room_ - at, tail_ - oldest});
    const auto block = std::span(old_).first(bytes);
    if (auto read = readAll(fd_, offset_ + at, block); !read) return read;
    // Records begin at whole words, so their first two bytes are in one piece.
    const std::uint64_t start = oldest;
    while (oldest < position && oldest - start < bytes) {
      const auto words = static_cast<std::uint8_t>(block[oldest - start + offsetof(RecordHeader, words)]);
      if (words * kWord < sizeof(RecordHeader)) return fail("somebody else has written to the file");
      oldest += words * kWord;
    }
  }
  // Before the first byte is overwritten: a reader, or one who reads after a crash, starts behind it.
  oldest_ = oldest;
  std::atomic_ref(control_.oldest).store(oldest, std::memory_order_seq_cst);
  return {};
}

}  // namespace rc10::blackbox
