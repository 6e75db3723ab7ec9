#pragma once

#include <cstdint>
#include <optional>

#include "app/time.hpp"
#include "drives/damiao/damiao_frames.hpp"
#include "motor/enable_sequence.hpp"

namespace rc10 {

/// Enable sequence of a Damiao drive: it is disabled, tells the scales of its frames, takes its control mode
/// and its watchdog and tells both back, tells its position, and only then is enabled. Every register is
/// written to RAM only. Scheduler thread only.
class DamiaoEnabling {
 public:
  struct Plan {
    int id = 0;
    DamiaoControl control = DamiaoControl::kMit;
    std::uint32_t timeout = 0;  ///< In steps of damiao::kTimeoutStepMs.
    DamiaoScale scale;
  };
  /// To be sent to the id of the registers, or as a control frame.
  struct Request {
    bool of_register = false;
    damiao::Payload payload{};
  };

  explicit DamiaoEnabling(const Plan& plan) noexcept;

  void begin() noexcept;
  /// Unanswered for too long: no more.
  void update(MonotonicTime now) noexcept;
  void onStatus(std::uint8_t status) noexcept;
  /// Any answer about a register, to whomever: one that contradicts what has been confirmed fails the
  /// sequence, also after its end.
  void onReply(const damiao::RegisterReply& reply) noexcept;
  /// Whether the drive's own count is known now.
  void onPosition(bool known) noexcept;

  /// Request that is due now, if any.
  [[nodiscard]] std::optional<Request> take(MonotonicTime now) noexcept;
  /// The drive is still disabled, and may be told so again to get its feedback.
  [[nodiscard]] bool quiet() const noexcept { return sequence_.step() < kEnable; }
  [[nodiscard]] SequenceProgress progress() const noexcept { return sequence_.progress(); }
  /// The register that differs from the plan, or that the drive does not tell.
  [[nodiscard]] std::optional<damiao::Register> culprit() const noexcept { return culprit_; }
  void forgive() noexcept { culprit_.reset(); }

 private:
  enum Step : std::uint8_t {
    kDisable,
    kReadPMax,
    kReadVMax,
    kReadTMax,
    kWriteControl,
    kReadControl,
    kWriteTimeout,
    kReadTimeout,
    kReadPosition,
    kEnable,
  };

  [[nodiscard]] std::optional<damiao::Register> registerOf(Step step) const noexcept;
  [[nodiscard]] Request request() const noexcept;
  [[nodiscard]] bool asPlanned(const damiao::RegisterReply& reply) const noexcept;
  /// The drive has told the planned value already.
  [[nodiscard]] bool confirmed(damiao::Register address) const noexcept;
  void next() noexcept;
  void fail() noexcept;

  Plan plan_;
  EnableSequence<Step> sequence_;
  std::optional<damiao::Register> culprit_;
};

}  // namespace rc10
