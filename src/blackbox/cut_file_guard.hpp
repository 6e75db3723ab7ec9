#pragma once

#include <cstddef>

namespace rc10::blackbox {

/// Keeps a process alive whose mapped file somebody cuts off: the kernel answers the next access behind the
/// file's end with SIGBUS. Private memory of the same size then takes the place of the mapping, its contents
/// lost. A SIGBUS from elsewhere does what it did before.
class CutFileGuard {
 public:
  CutFileGuard() = default;
  CutFileGuard(const CutFileGuard&) = delete;
  CutFileGuard& operator=(const CutFileGuard&) = delete;
  ~CutFileGuard();

  /// Not for real-time threads. False: no handler or no place for one mapping more.
  [[nodiscard]] bool watch(void* memory, std::size_t bytes) noexcept;
  /// Whether the file was found cut off. Any thread.
  [[nodiscard]] bool replaced() const noexcept;

 private:
  std::size_t place_ = kNoPlace;

  static constexpr std::size_t kNoPlace = ~std::size_t{0};
};

}  // namespace rc10::blackbox
