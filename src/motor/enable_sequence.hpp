#pragma once

#include "app/time.hpp"
#include "motor/drive_frames.hpp"

namespace rc10 {

/// Rhythm of an enable sequence: a step that is not answered is asked for again after `patience`, and given
/// up when it has been asked for `tries` times. Scheduler thread only.
class EnableRhythm {
 public:
  EnableRhythm(Duration patience, int tries) noexcept : patience_(patience), tries_(tries) {}

  [[nodiscard]] SequenceProgress progress() const noexcept { return progress_; }
  [[nodiscard]] bool pending() const noexcept { return progress_ == SequenceProgress::kPending; }
  [[nodiscard]] bool done() const noexcept { return progress_ == SequenceProgress::kDone; }
  [[nodiscard]] bool failed() const noexcept { return progress_ == SequenceProgress::kFailed; }
  /// An answer counts: the step has been asked for.
  [[nodiscard]] bool awaits() const noexcept { return pending() && asked_ > 0; }
  /// The step's first question.
  [[nodiscard]] MonotonicTime askedFirst() const noexcept { return asked_first_; }

  /// Is the step to be asked for now? Counts it; fails where that would be once too often.
  [[nodiscard]] bool asks(MonotonicTime now) noexcept;
  /// The last question, too, has gone unanswered for its time.
  [[nodiscard]] bool exhausted(MonotonicTime now) const noexcept;
  void finish() noexcept { progress_ = SequenceProgress::kDone; }
  void fail() noexcept { progress_ = SequenceProgress::kFailed; }

 protected:
  void restart() noexcept;
  void enterStep() noexcept { asked_ = 0; }

 private:
  Duration patience_;
  int tries_;
  SequenceProgress progress_ = SequenceProgress::kPending;
  int asked_ = 0;  ///< Times, for the present step.
  MonotonicTime asked_first_{};
  MonotonicTime asked_last_{};
};

/// The steps of a family, its own enum, in that rhythm.
template <typename Step>
class EnableSequence : public EnableRhythm {
 public:
  using EnableRhythm::EnableRhythm;

  void begin(Step first) noexcept {
    restart();
    step_ = first;
  }
  /// The step is answered.
  void next(Step step) noexcept {
    enterStep();
    step_ = step;
  }
  /// After a failure that at which it failed.
  [[nodiscard]] Step step() const noexcept { return step_; }
  [[nodiscard]] bool at(Step step) const noexcept { return pending() && step_ == step; }
  /// Waiting for the answer to this step.
  [[nodiscard]] bool awaits(Step step) const noexcept { return EnableRhythm::awaits() && step_ == step; }
  using EnableRhythm::awaits;

 private:
  Step step_{};
};

}  // namespace rc10
