#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "app/time.hpp"
#include "motor/drive_setup.hpp"

namespace rc10 {

/// Writes settings to a drive, one after the other: writes, reads back, compares, writes again if it differs;
/// then stores them. Begun by a person's request only. Its motor is at rest meanwhile: the motor passes on
/// every frame of its drive, and packs these frames beside its own. Scheduler thread only.
class DriveConfiguring {
 public:
  enum class Progress : std::uint8_t {
    kNone,  ///< Never asked.
    kPending,
    kDone,
    kNotConfirmed,  ///< One setting was not read back as written; nothing after it was written or stored.
    kNotSaved,      ///< All are written, but the drive does not say that they are stored.
  };

  /// `codec` outlives this.
  explicit DriveConfiguring(const DriveCodec& codec) noexcept : codec_(codec) {}

  void begin(const DriveWrite& write) noexcept;
  void cancel() noexcept { phase_ = Phase::kEnded; }
  void onFrame(const CanFrame& frame) noexcept;
  /// Frames of this tick: at most one.
  [[nodiscard]] std::size_t pack(MonotonicTime now, std::span<CanFrame> out) noexcept;

  /// Nothing else may be sent to the drive, which is at rest: the next frame of it is the answer to the save
  /// frame.
  [[nodiscard]] bool wantsSilence() const noexcept;
  /// The drive writes its flash, or is sent nothing: until it is heard again, or 0.6 s have passed, its
  /// silence does not say that it is gone.
  [[nodiscard]] bool excusesSilence() const noexcept;

  [[nodiscard]] Progress progress() const noexcept { return progress_; }
  /// Which of the values it is at, or failed at.
  [[nodiscard]] std::size_t index() const noexcept { return index_; }

 private:
  enum class Phase : std::uint8_t { kWrite, kWritten, kRead, kSave, kSaving, kUnsaved, kEnded };

  [[nodiscard]] const DriveValue& value() const noexcept { return write_.values[index_]; }
  [[nodiscard]] bool changesIdentity() const noexcept;
  [[nodiscard]] bool asWritten() const noexcept;
  void look(MonotonicTime now) noexcept;
  void lookForReading(MonotonicTime now) noexcept;
  void lookForSaving(MonotonicTime now) noexcept;
  void lookForLife(MonotonicTime now) noexcept;
  void next(MonotonicTime now) noexcept;
  void enter(Phase phase, MonotonicTime now) noexcept;
  /// The drive no longer answers under its old identity.
  void rename() noexcept;
  void end(Progress progress) noexcept;

  const DriveCodec& codec_;
  DriveWrite write_;
  Progress progress_ = Progress::kNone;
  Phase phase_ = Phase::kEnded;
  std::size_t index_ = 0;
  int tries_ = 0;
  MonotonicTime sent_at_{};  ///< Last frame to the drive, or last enter().
  std::optional<double> reading_;
  bool heard_ = false;  ///< Any frame of the drive since the last one to it.
  bool saved_ = false;
  std::optional<int> new_id_;  ///< It answers under this one by now, not only after a restart.
  bool renamed_ = false;
};

}  // namespace rc10
