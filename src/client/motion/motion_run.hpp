#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "app/target.hpp"
#include "app/time.hpp"
#include "client/catch_up.hpp"
#include "client/motion/abort_criteria.hpp"
#include "client/motion/curve.hpp"
#include "client/motion/excitation.hpp"
#include "link/link_protocol.hpp"

namespace rc10::client {

/// Test of one motor. Targets of total_angle count from where it stands at the start.
struct MotionSettings {
  std::string client;  ///< Name under which the targets are sent.
  std::string motor;
  ControlMode mode = ControlMode::kVelocity;
  ExcitationSettings excitation;
  AbortCriteria criteria;
  /// The motor is let go this long after the last target: of a client that has died, or that a busy computer
  /// keeps from its processor.
  std::int32_t validity_ms = 200;
};

/// Runs a test of motion over a connection that is not its own: takes what rc10d sends, says what to send.
/// Judges each tick; at the first criterion that is not met, and at the end, the target lapses and the
/// motor's on_timeout acts. It knows no clock, and does not wait.
class MotionRun {
 public:
  static constexpr Duration kSendPeriod = std::chrono::milliseconds{2};
  /// Longest time for which a target outlives the excitation, whatever MotionSettings::validity_ms is.
  static constexpr Duration kLease = std::chrono::milliseconds{200};

  /// The error says why the test must not begin: no such motor or mode, or a target beyond the criteria.
  [[nodiscard]] static Result<MotionRun> of(const link::Welcome& welcome, const MotionSettings& settings);

  /// The signals of each tick that it needs: to be sent once, at the start.
  [[nodiscard]] link::TraceChoice choice() const noexcept;

  void take(const link::Trace& trace);
  void take(const link::State& state);
  void take(const link::Event& event);
  /// Ends it: Ctrl-C, a page that was left, or rc10d is gone.
  void end(Criterion criterion, const std::string& text);

  struct Order {
    Target target;
    std::int32_t validity_ms = 0;
  };
  /// The target to be sent now; nothing: none is due.
  [[nodiscard]] std::optional<Order> order(MonotonicTime now);
  /// order() has nothing before that.
  [[nodiscard]] MonotonicTime due() const noexcept { return due_; }

  /// The motor has been let go, or is another's.
  [[nodiscard]] bool over() const noexcept { return phase_ == Phase::kOver; }
  /// Reason why it ended before its time.
  [[nodiscard]] const std::optional<Abort>& aborted() const noexcept { return abort_; }
  /// The ticks in which its target was in force.
  [[nodiscard]] const Curve& curve() const noexcept { return curve_; }
  [[nodiscard]] const MotionSettings& settings() const noexcept { return settings_; }
  /// Its place in Welcome and State.
  [[nodiscard]] std::size_t motor() const noexcept { return motor_; }
  /// Added to the values of the excitation.
  [[nodiscard]] double origin() const noexcept { return origin_; }
  [[nodiscard]] double tickS() const noexcept { return 1.0 / welcome_.rate_hz; }
  /// Its time if nothing ends it before.
  [[nodiscard]] double timeS() const noexcept { return excitation_.timeS(); }

 private:
  enum class Phase : std::uint8_t { kPreparing, kRunning, kLettingGo, kOver };
  struct Row {
    std::int64_t mono_us = 0;
    std::int64_t tick = 0;
    CurveSample sample;
    MotorStatus status{};
    Acting acting{};
  };
  struct Sent {
    MonotonicTime time;
    double value = 0.0;
  };

  MotionRun(const link::Welcome& welcome, const MotionSettings& settings, const Excitation& excitation,
            std::size_t motor)
      : welcome_(welcome), settings_(settings), excitation_(excitation), motor_(motor) {}

  [[nodiscard]] Row rowOf(const link::Trace& trace, const link::TraceRow& row) const;
  void take(const Row& row);
  void abort(const Abort& found);
  [[nodiscard]] bool isOurs(const Row& row) const noexcept;
  [[nodiscard]] std::optional<Abort> whyNotBegin(MonotonicTime now) const;
  [[nodiscard]] std::optional<Abort> silence(MonotonicTime now) const;
  [[nodiscard]] std::string whoHasIt() const;
  /// The motor in the newest state; null: no state has it.
  [[nodiscard]] const link::MotorState* knownMotor() const noexcept {
    return state_ && motor_ < state_->motor_count ? &state_->motors[motor_] : nullptr;
  }
  [[nodiscard]] Order orderAt(double time_s, MonotonicTime now);
  void finish();

  link::Welcome welcome_;
  MotionSettings settings_;
  Excitation excitation_;
  std::size_t motor_;

  Phase phase_ = Phase::kPreparing;
  MonotonicTime due_{};
  std::optional<MonotonicTime> asked_;  ///< When order() was first called.
  MonotonicTime start_{};
  MonotonicTime let_go_{};
  double origin_ = 0.0;
  double start_value_ = 0.0;  ///< Value of the excitation, from which it approaches its base.
  double start_deg_ = 0.0;
  std::optional<link::State> state_;
  bool untraced_ = false;  ///< rc10d traces not all of the signals: other clients have its room.
  std::optional<Row> newest_;
  std::deque<Sent> sent_;       ///< Targets of the last second.
  MonotonicTime acts_until_{};  ///< The last of them does.
  CatchUp catch_up_;
  std::int64_t taken_tick_ = 0;  ///< 0: its target has not been in force.
  std::int64_t taken_us_ = 0;
  bool lost_ = false;  ///< Another's, or at rest: nothing is sent any more.
  std::string refusal_;
  std::optional<Abort> abort_;
  Curve curve_;
};

}  // namespace rc10::client
