#pragma once

#include <cstdint>

#include "app/message_limits.hpp"
#include "app/time.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Right to command a motor: held by the client whose setpoint it obeys, for as long as that is valid. Others
/// of the same or a lower priority have to wait; a higher one takes over. Scheduler thread only.
class Lease {
 public:
  struct Holder {
    link::Name client;
    std::uint64_t session = 0;
    std::int32_t priority = 0;
  };

  /// From when this host received the command until it lapses.
  struct Term {
    MonotonicTime received{};
    MonotonicTime until{};

    /// The last word of a program that leaves: what it said before, for an instant.
    [[nodiscard]] bool ends() const noexcept { return until - received <= kEndValidity; }
  };

  /// Somebody has taken it, though it may have lapsed since.
  [[nodiscard]] bool taken() const noexcept { return taken_; }
  [[nodiscard]] bool held(MonotonicTime now) const noexcept { return now < term_.until; }

  [[nodiscard]] bool isHolder(const Holder& other) const noexcept {
    return other.session == holder_.session && other.client.equals(holder_.client);
  }
  [[nodiscard]] bool allows(const Holder& other, MonotonicTime now) const noexcept {
    return !held(now) || isHolder(other) || other.priority > holder_.priority;
  }
  /// An end is taken from the holder alone: another's could bring back a target that was displaced or
  /// refused.
  [[nodiscard]] bool allows(const Holder& other, const Term& term, MonotonicTime now) const noexcept {
    return term.ends() ? held(now) && isHolder(other) : allows(other, now);
  }

  void take(const Holder& holder, const Term& term) noexcept {
    holder_ = holder;
    term_ = term;
    taken_ = true;
  }
  /// The holder has said something newer, which is past already.
  void shorten(const Holder& sender, MonotonicTime until) noexcept {
    if (isHolder(sender) && until < term_.until) term_.until = until;
  }
  void release() noexcept { *this = Lease{}; }

  /// Empty when nobody has it.
  [[nodiscard]] const link::Name& client() const noexcept { return holder_.client; }
  /// Time of the command in force; 0 when there is none.
  [[nodiscard]] MonotonicTime received() const noexcept { return term_.received; }

 private:
  Holder holder_;
  Term term_;
  bool taken_ = false;
};

}  // namespace rc10
