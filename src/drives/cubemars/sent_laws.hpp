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

  /// The one before it, which acts until the last has arrived.
  [[nodiscard]] const SpringLaw& lastButOne() const noexcept { return sent(1).law; }

  /// Whether `fits(law)` for one that was in force after `since`.
  template <typename Fits>
  [[nodiscard]] bool anySince(MonotonicTime since, Fits fits) const noexcept {
    for (std::size_t back = 0; back < kKept; ++back) {
      if (fits(sent(back).law)) return true;
      if (sent(back).at <= since) return false;
    }
    return false;
  }

 private:
  struct Sent {
    SpringLaw law{};
    MonotonicTime at{};
  };
  static constexpr std::size_t kKept = 42;  // 10 ms at 4 kHz, and those at its ends

  [[nodiscard]] const Sent& sent(std::size_t back) const noexcept {
    return laws_[(newest_ + kKept - back) % kKept];
  }

  std::array<Sent, kKept> laws_{};
  std::size_t newest_ = 0;
};

}  // namespace rc10
