#pragma once

#include <cstdint>

namespace rc10::test {

/// Counts what the calling thread allocates while the guard lives: malloc and its relatives (operator new
/// among them) and mmap. Use on one thread only.
///
///   AllocGuard guard;
///   bus.flush();
///   EXPECT_EQ(guard.allocations(), 0U);
///
/// Under a sanitizer, whose own malloc must stay in place, and on a C library other than glibc it counts
/// operator new alone.
class AllocGuard {
 public:
  AllocGuard() noexcept;
  AllocGuard(const AllocGuard&) = delete;
  AllocGuard& operator=(const AllocGuard&) = delete;
  ~AllocGuard() = default;

  /// Allocations of this thread since construction.
  [[nodiscard]] std::uint64_t allocations() const noexcept;

  /// Whether malloc and mmap are counted, or operator new alone.
  [[nodiscard]] static bool countsMalloc() noexcept;

 private:
  std::uint64_t at_construction_;
};

}  // namespace rc10::test
