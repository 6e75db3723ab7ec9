#pragma once

#include <array>
#include <cstddef>

#include "app/time.hpp"
#include "motor/spring_law.hpp"

namespace rc10 {

/// The laws that were sent last, with their times: an answer may show one that was replaced meanwhile.
class SentLaws {
 public:
  void add(const SpringLaw& law, MonotonicTime sent) noexcept {
    newest_ = (newest_ + 1) % kKept;
    laws_[newest_] = {law, sent};
  }
  /// "No torque" before the first.
  [[nodiscard]] const SpringLaw& last() const noexcept { return laws_[newest_].law; }

  /// Each law that was in force after `since`: those sent later, and the one before them. The one before the
  /// last is always among them: the last may not have arrived.
  template <typename Visit>
  void forEach(MonotonicTime since, Visit visit) const noexcept {
    for (std::size_t back = 0; back < kKept; ++back) {
      const Sent& sent = laws_[(newest_ + kKept - back) % kKept];
      visit(sent.law);
      if (back > 0 && sent.at <= since) return;
    }
  }

 private:
  struct Sent {
    SpringLaw law{};
    MonotonicTime at{};
  };
  static constexpr std::size_t kKept = 12;  // 10 ms at 1 kHz, and those at its ends

  std::array<Sent, kKept> laws_{};
  std::size_t newest_ = 0;
};

}  // namespace rc10
