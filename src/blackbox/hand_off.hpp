#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "blackbox/format.hpp"

namespace rc10::blackbox {

/// The writing end of the hand-off ring. Scheduler thread only: plain stores and one release store, no lock,
/// no allocation, no system call. When the io thread falls behind by a whole ring, records are dropped and
/// counted.
class HandOff {
 public:
  /// `ring`: a power of two of bytes, outliving this.
  HandOff(Control& control, std::span<std::byte> ring) noexcept : control_(control), ring_(ring) {}

  /// Writes the first `bytes` of `record`, rounded up to whole words, and fills in its type and size.
  template <typename Record>
  bool write(Record& record, std::size_t bytes = sizeof(Record)) noexcept {
    static_assert(kIsRecord<Record>);
    const std::size_t size = std::min((bytes + kWord - 1) / kWord * kWord, sizeof(Record));
    record.header.type = Record::kType;
    record.header.words = static_cast<std::uint8_t>(size / kWord);
    return append({reinterpret_cast<const std::byte*>(&record), size});
  }

 private:
  bool append(std::span<const std::byte> record) noexcept {
    if (head_ + record.size() - tail_seen_ > ring_.size()) {
      // Acquire: the io thread has read what lay here before.
      tail_seen_ = std::atomic_ref(control_.tail).load(std::memory_order_acquire);
      if (head_ + record.size() - tail_seen_ > ring_.size()) {
        std::atomic_ref(control_.dropped).store(++dropped_, std::memory_order_relaxed);
        return false;
      }
    }
    const std::size_t at = head_ & (ring_.size() - 1);
    const std::size_t first = std::min(record.size(), ring_.size() - at);
    std::memcpy(ring_.data() + at, record.data(), first);
    if (first < record.size()) std::memcpy(ring_.data(), record.data() + first, record.size() - first);
    head_ += record.size();
    // Release: whoever sees the new end sees the record.
    std::atomic_ref(control_.head).store(head_, std::memory_order_release);
    return true;
  }

  Control& control_;
  std::span<std::byte> ring_;
  std::uint64_t head_ = 0;
  std::uint64_t tail_seen_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace rc10::blackbox
