#pragma once

#include <atomic>
#include <cstdint>

#include "app/result.hpp"
#include "app/unique_fd.hpp"

namespace rc10::link {

/// Memory that rc10d and rc10-guard share. Neither waits for the other. A page of its own, so that the guard
/// still reads it when rc10d is dead.
struct GuardPage {
  std::atomic<std::uint64_t> ticks{0};  ///< rc10d: executed ticks. 0: no drive has been commanded yet.
  std::atomic<bool> ended{false};       ///< rc10d: an orderly end; its drives are at rest.
  std::atomic<bool> acted{false};       ///< Guard: it sent rest frames; rc10d answers with an e-stop.
  std::atomic<std::uint32_t> beats{0};  ///< Guard: its wake-ups; rc10d sees whether it runs.
};
// An rc10d and a guard of different versions share it during an upgrade.
static_assert(sizeof(GuardPage) == 16);
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

/// The memory behind a GuardPage: mapped as long as the object lives.
class SharedGuardPage {
 public:
  /// A new page, for rc10d. Its size is sealed: what the guard maps cannot be cut off.
  [[nodiscard]] static Result<SharedGuardPage> create();
  /// The page behind a descriptor that another process sent. Refuses what is no sealed page.
  [[nodiscard]] static Result<SharedGuardPage> map(UniqueFd descriptor);

  SharedGuardPage(SharedGuardPage&& other) noexcept;
  SharedGuardPage& operator=(SharedGuardPage&& other) noexcept;
  SharedGuardPage(const SharedGuardPage&) = delete;
  SharedGuardPage& operator=(const SharedGuardPage&) = delete;
  ~SharedGuardPage();

  [[nodiscard]] GuardPage& operator*() const noexcept { return *page_; }
  [[nodiscard]] GuardPage* operator->() const noexcept { return page_; }
  [[nodiscard]] int descriptor() const noexcept { return descriptor_.get(); }

 private:
  SharedGuardPage(UniqueFd descriptor, GuardPage* page) noexcept
      : descriptor_(std::move(descriptor)), page_(page) {}

  UniqueFd descriptor_;
  GuardPage* page_;
};

}  // namespace rc10::link
