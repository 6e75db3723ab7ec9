#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

namespace rc10 {

/// State of a contact of the safety circuit, closed while all is well.
enum class ContactState : std::uint8_t {
  kAbsent,      ///< None is configured.
  kClosed,      ///< All is well.
  kOpen,        ///< Pressed, or a wire is off.
  kUnreadable,  ///< The chip is gone, or nobody looks any more.
  kReleased,    ///< The enabling switch is released or squeezed.
};

/// A contact on its way from the thread that watches it to the scheduler: the e-stop input with the enabling
/// switch, or the mode input. Neither side waits. An opening is never missed, however short; and silence of
/// the watcher counts as unreadable.
class SafetyContact {
 public:
  /// The watcher looks far more often; in ticks that were executed, so that a computer that stood still
  /// as a whole is no silence.
  static constexpr float kMaxSilenceSeconds = 0.2F;

  /// Sets the present state of the input. Watching thread only.
  void show(ContactState state) noexcept {
    state_.store(state, std::memory_order_relaxed);
    if (state != ContactState::kClosed) {
      opened_as_.store(state, std::memory_order_relaxed);
      openings_.fetch_add(1, std::memory_order_relaxed);
    }
    sightings_.fetch_add(1, std::memory_order_release);
  }

  struct View {
    bool opened = false;               ///< Open now, or since the last look.
    std::optional<ContactState> news;  ///< Change, for the event.
  };
  /// Once in each tick. Scheduler thread only.
  [[nodiscard]] View look(float dt_s) noexcept;
  /// As of the last look: `clear` must wait. Scheduler thread only.
  [[nodiscard]] bool open() const noexcept { return open_; }

 private:
  std::atomic<ContactState> state_{ContactState::kAbsent};
  std::atomic<ContactState> opened_as_{ContactState::kOpen};  // the watcher's; ordered by sightings_
  std::atomic<std::uint32_t> openings_{0};
  std::atomic<std::uint32_t> sightings_{0};
  // Counts of the scheduler.
  std::uint32_t seen_openings_ = 0;
  std::uint32_t seen_sightings_ = 0;
  float silence_s_ = 0.0F;
  bool open_ = false;
  ContactState told_ = ContactState::kClosed;
};

}  // namespace rc10
