#pragma once

#include <array>
#include <atomic>
#include <cstddef>

#include "daemon/exchange/histogram.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Ages of commands by client: a histogram for each of the first kNamed names, one for all further clients.
/// The scheduler writes, any thread reads.
class ClientAges {
 public:
  static constexpr std::size_t kNamed = 12;

  void record(const link::Name& client, Duration age) noexcept {
    const auto known = count_.load(std::memory_order_relaxed);
    std::size_t place = 0;
    while (place < known && names_[place].chars != client.chars) ++place;
    if (place == kNamed) return others_.record(age);
    ages_[place].record(age);
    if (place < known) return;
    names_[place] = client;
    count_.store(known + 1, std::memory_order_release);  // the name is complete
  }

  /// Clients with a histogram of their own, in the order of their first command.
  [[nodiscard]] std::size_t count() const noexcept { return count_.load(std::memory_order_acquire); }
  /// `client`: below count(), as in of().
  [[nodiscard]] const link::Name& name(std::size_t client) const noexcept { return names_[client]; }
  [[nodiscard]] const DurationHistogram& of(std::size_t client) const noexcept { return ages_[client]; }
  [[nodiscard]] const DurationHistogram& ofOthers() const noexcept { return others_; }

 private:
  std::array<link::Name, kNamed> names_{};
  std::array<DurationHistogram, kNamed> ages_{};
  DurationHistogram others_;
  std::atomic<std::size_t> count_{0};
};

}  // namespace rc10
