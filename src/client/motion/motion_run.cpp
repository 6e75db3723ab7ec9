#include "client/motion/motion_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "app/event_code.hpp"
#include "app/limits.hpp"
#include "app/printable.hpp"
#include "app/text_table.hpp"
#include "client/find_motor.hpp"
#include "client/obstacle.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

// Timeouts: for its first target to be in force, and for the first rows of the trace.
constexpr Duration kUntilTaken = std::chrono::milliseconds{500};
constexpr Duration kUntilTraced = std::chrono::seconds{3};
// Timeout for the state that shows that its lease has lapsed.
constexpr Duration kUntilLetGo = std::chrono::seconds{2};
constexpr Duration kSentKept = std::chrono::seconds{1};

// A row has these at their places in Trace::signals.
constexpr std::array<std::string_view, 9> kTestedReadings{"target",       "target_shaped", "total_angle_deg",
                                                          "velocity_rpm", "current_a",     "feedback_age_us",
                                                          "limits",       "status",        "acting"};

constexpr std::uint16_t placeOf(std::string_view reading) {
  const auto& all = link::kTraceReadings;
  return static_cast<std::uint16_t>(std::find(all.begin(), all.end(), reading) - all.begin());
}

link::TraceSignal signalOf(std::size_t motor, std::string_view reading) {
  return {link::TraceSource::kMotor, static_cast<std::uint16_t>(motor), placeOf(reading)};
}

// NaN: the trace has not this signal.
double valueIn(const link::Trace& trace, const link::TraceRow& row, const link::TraceSignal& signal) {
  const auto end = trace.signals.begin() + std::min<std::size_t>(trace.signal_count, trace.signals.size());
  const auto found = std::find(trace.signals.begin(), end, signal);
  return found == end ? std::numeric_limits<double>::quiet_NaN()
                      : row.values[static_cast<std::size_t>(found - trace.signals.begin())];
}

bool traces(const link::Trace& trace, std::size_t motor) {
  const auto end = trace.signals.begin() + std::min<std::size_t>(trace.signal_count, trace.signals.size());
  return std::all_of(kTestedReadings.begin(), kTestedReadings.end(), [&](auto reading) {
    return std::find(trace.signals.begin(), end, signalOf(motor, reading)) != end;
  });
}

Abort withText(Criterion criterion, const std::string& text) {
  Abort abort;
  abort.criterion = criterion;
  abort.text = text;
  return abort;
}

double sinceS(MonotonicTime then, MonotonicTime now) {
  return std::chrono::duration<double>(now - then).count();
}

std::int64_t asUs(MonotonicTime time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
}

}  // namespace

Result<MotionRun> MotionRun::of(const link::Welcome& welcome, const MotionSettings& settings) {
  const auto motor = findMotor(welcome, settings.motor);
  if (!motor) return tl::unexpected(motor.error());
  const auto excitation = Excitation::of(settings.excitation);
  if (!excitation) return tl::unexpected(excitation.error());
  if (const auto fit = admits(settings.criteria, *excitation, settings.mode); !fit)
    return tl::unexpected(fit.error());
  if (settings.mode == ControlMode::kTotalAngle && settings.excitation.base != 0.0)
    return fail("targets of total_angle count from where the motor stands: leave the base out");
  const auto modes = welcome.motors[*motor].modes;
  if ((modes & (1U << static_cast<unsigned>(settings.mode))) == 0)
    return fail("motor '" + printable(settings.motor) + "' has no mode " + toString(settings.mode) +
                "; it has " + link::modeWords(modes));
  return MotionRun(welcome, settings, *excitation, *motor);
}

link::TraceChoice MotionRun::choice() const noexcept {
  link::TraceChoice choice;
  for (const auto reading : kTestedReadings)
    choice.signals[choice.signal_count++] = signalOf(motor_, reading);
  return choice;
}

MotionRun::Row MotionRun::rowOf(const link::Trace& trace, const link::TraceRow& row) const {
  const auto value = [&](std::string_view reading) { return valueIn(trace, row, signalOf(motor_, reading)); };
  Row read;
  read.mono_us = row.mono_us;
  read.tick = row.tick;
  read.sample = {.target = value("target"),
                 .target_shaped = value("target_shaped"),
                 .total_angle_deg = value("total_angle_deg"),
                 .velocity_rpm = value("velocity_rpm"),
                 .current_a = value("current_a"),
                 .feedback_age_us = value("feedback_age_us"),
                 .limits = static_cast<std::uint32_t>(value("limits"))};
  const auto measured = measuredMember(settings_.mode);
  if (measured != nullptr) read.sample.measured = read.sample.*measured;
  read.status = static_cast<MotorStatus>(value("status"));
  read.acting = static_cast<Acting>(value("acting"));
  return read;
}

void MotionRun::take(const link::Trace& trace) {
  untraced_ = !traces(trace, motor_);
  if (untraced_) return;
  for (const auto& row :
       std::span{trace.rows}.first(std::min<std::size_t>(trace.row_count, link::kMaxTraceRows))) {
    take(rowOf(trace, row));
  }
}

void MotionRun::take(const Row& row) {
  newest_ = row;
  if (phase_ != Phase::kRunning || row.mono_us < asUs(start_)) return;
  const bool ours = isOurs(row);
  if (ours && taken_tick_ == 0) {
    taken_tick_ = row.tick;
    taken_us_ = row.mono_us;
  }
  // It was ACTIVE when the first target left: an e-stop may come before that is taken.
  if (row.status != MotorStatus::kActive) return abort(withText(Criterion::kStatus, {}));
  if (taken_tick_ == 0) return;
  if (!ours) return abort(withText(Criterion::kOwnership, {}));
  curve_.push_back(row.sample);
  curve_.back().time_s = static_cast<double>(row.mono_us - taken_us_) / 1e6;
  CurveSample judged = row.sample;
  if (curve_.back().time_s < Excitation::kLeadS) judged.limits = 0;  // a soft start is no disturbance
  if (const auto found = judge(settings_.criteria, judged, start_deg_)) abort(*found);
}

bool MotionRun::isOurs(const Row& row) const noexcept {
  return row.acting == Acting::kTarget && std::any_of(sent_.rbegin(), sent_.rend(), [&row](const Sent& sent) {
           return sent.value == row.sample.target;
         });
}

void MotionRun::take(const link::State& state) {
  state_ = state;
  if (knownMotor() == nullptr) return;
  const auto owner = state.motors[motor_].owner.view();
  const bool ours = owner == settings_.client;
  if (phase_ == Phase::kRunning && (taken_tick_ == 0 || state.tick > taken_tick_)) {
    if (state.motors[motor_].status != MotorStatus::kActive || state.robot_state != RobotStatus::kRun)
      abort(withText(Criterion::kStatus, {}));
    else if (taken_tick_ != 0 && !ours)
      abort(withText(Criterion::kOwnership, {}));
  }
  if (phase_ == Phase::kLettingGo && !ours) finish();
}

void MotionRun::take(const link::Event& event) {
  if (auto why = refusalText(event, settings_.motor, settings_.client); !why.empty())
    refusal_ = std::move(why);
}

void MotionRun::end(Criterion criterion, const std::string& text) {
  abort(withText(criterion, text));
  if (criterion == Criterion::kConnection) finish();
}

void MotionRun::abort(const Abort& found) {
  if (phase_ == Phase::kOver || abort_) return;
  abort_ = found;
  lost_ = found.criterion == Criterion::kStatus || found.criterion == Criterion::kOwnership;
  due_ = {};
  if (phase_ == Phase::kPreparing) finish();
}

void MotionRun::finish() {
  phase_ = Phase::kOver;
  if (!abort_ || !abort_->text.empty()) return;
  // In words by the newest state, which may be later than the tick that ended the test.
  if (const auto* motor = knownMotor(); motor != nullptr && state_ && abort_->criterion == Criterion::kStatus)
    abort_->text = obstacle(*state_, settings_.motor, *motor);
  if (abort_->criterion == Criterion::kOwnership) abort_->text = whoHasIt();
  if (abort_->text.empty())
    abort_->text = "motor '" + settings_.motor + "' did not obey for some ticks: see `rc10ctl watch`";
}

std::string MotionRun::whoHasIt() const {
  const std::string name = "motor '" + settings_.motor + "'";
  const auto* motor = knownMotor();
  const auto owner = motor != nullptr ? motor->owner.view() : std::string_view{};
  if (!owner.empty() && owner != settings_.client)
    return name + " is held by " + holder(welcome_, owner) + ", or take over with a higher priority";
  if (taken_tick_ == 0)
    return name + " did not take the target" +
           (refusal_.empty() ? ": `rc10ctl stats` shows what was refused" : " (" + refusal_ + ")");
  return owner.empty()
             ? "the target lapsed: this computer was too busy to renew it within " +
                   std::to_string(settings_.validity_ms) + " ms: end other programs, and see `rc10ctl doctor`"
             : name + " obeys another program of this name: end that one";
}

std::optional<Abort> MotionRun::whyNotBegin(MonotonicTime now) const {
  if (untraced_)
    return withText(Criterion::kConnection,
                    "rc10d traces " + std::to_string(link::kMaxTraceSignals) +
                        " signals at most, and other clients have chosen theirs: close plots of the page");
  if (const auto* motor = knownMotor(); motor != nullptr && state_) {
    const auto why = obstacle(*state_, settings_.motor, *motor);
    if (!why.empty()) return withText(Criterion::kStatus, why);
    if (newest_ && settings_.mode == ControlMode::kTotalAngle &&
        !std::isfinite(newest_->sample.total_angle_deg))
      return withText(Criterion::kAngle, "the angle of '" + settings_.motor +
                                             "' is not known: `rc10ctl zero " + settings_.motor + "`");
  }
  if (!asked_ || now - *asked_ < kUntilTraced) return std::nullopt;
  return withText(Criterion::kConnection,
                  "rc10d sends no states: is it stopped? See `systemctl status rc10d`");
}

// States and rows are some 10 ms old when they come.
std::optional<Abort> MotionRun::silence(MonotonicTime now) const {
  if (taken_tick_ == 0) {
    if (now - start_ < kUntilTaken) return std::nullopt;
    return withText(Criterion::kOwnership, {});
  }
  if (!newest_) return std::nullopt;
  CurveSample last = newest_->sample;
  last.feedback_age_us += static_cast<double>(asUs(now) - newest_->mono_us);
  if (last.feedback_age_us <= settings_.criteria.feedback_age_max_us) return std::nullopt;
  return judge(settings_.criteria, last, start_deg_);
}

MotionRun::Order MotionRun::orderAt(double time_s, MonotonicTime now) {
  const double value = origin_ + excitation_.valueAt(time_s, start_value_);
  sent_.push_back({now, value});
  while (now - sent_.front().time > kSentKept) sent_.pop_front();
  // A short pulse of a client that dies is not as long as the patience of a long test.
  const auto most = std::chrono::duration<double>(excitation_.timeS() - time_s) + kLease;
  const auto most_ms = std::chrono::duration_cast<std::chrono::milliseconds>(most).count();
  const auto validity_ms = std::min<std::int64_t>(settings_.validity_ms, most_ms);
  acts_until_ = now + std::chrono::milliseconds{validity_ms};
  return {.target = {.mode = settings_.mode, .value = value},
          .validity_ms = static_cast<std::int32_t>(validity_ms)};
}

std::optional<MotionRun::Order> MotionRun::order(MonotonicTime now) {
  const bool caught_up = catch_up_.done(now, newest_ ? newest_->mono_us : 0);
  if (!asked_) asked_ = now;
  if (phase_ == Phase::kPreparing) {
    if (const auto why = whyNotBegin(now)) abort(*why);
    if (phase_ == Phase::kOver) return std::nullopt;
    due_ = now + kSendPeriod;
    if (!caught_up || !newest_ || knownMotor() == nullptr) return std::nullopt;
    start_deg_ = newest_->sample.total_angle_deg;
    if (settings_.mode == ControlMode::kTotalAngle) origin_ = start_deg_;
    if (settings_.mode == ControlMode::kVelocity) start_value_ = finiteOr0(newest_->sample.velocity_rpm);
    start_ = now;
    phase_ = Phase::kRunning;
    return orderAt(0.0, now);
  }
  if (phase_ == Phase::kLettingGo && now - let_go_ > kUntilLetGo) finish();
  if (phase_ != Phase::kRunning) return std::nullopt;
  if (!abort_) {
    if (const auto why = silence(now)) abort(*why);
  }
  const double time_s = sinceS(start_, now);
  if (abort_ || time_s >= excitation_.timeS()) {
    phase_ = Phase::kLettingGo;
    let_go_ = now;
    due_ = now + kUntilLetGo;
    // One that has lapsed does not come back: on_timeout acts in its stead. Nor does one whose motor may have
    // been enabled anew.
    if (lost_ || !caught_up || now >= acts_until_) return std::nullopt;
    // The last target once more, for an instant: then on_timeout acts, as when the client has died.
    return Order{.target = {.mode = settings_.mode, .value = sent_.back().value}, .validity_ms = 1};
  }
  if (now < due_) return std::nullopt;
  if (!caught_up) {
    due_ = now + kSendPeriod;
    return std::nullopt;
  }
  due_ = std::max(due_ + kSendPeriod, now);
  return orderAt(time_s, now);
}

}  // namespace rc10::client
