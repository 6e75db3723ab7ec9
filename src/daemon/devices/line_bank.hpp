#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "module/device_needs.hpp"

namespace rc10 {

/// The GPIO lines of one module between the scheduler and the lines thread: levels as bits, in words that
/// neither side waits for.
class LineBank {
 public:
  struct Settings {
    std::string name;  ///< Name of the module.
    std::string chip;
    std::vector<GpioNeed::Input> inputs;
    std::vector<GpioNeed::Output> outputs;
    std::uint32_t safe_levels = 0;
  };

  /// `wake`: an eventfd that lives as long.
  LineBank(Settings settings, int wake)
      : settings_(std::move(settings)), wanted_(settings_.safe_levels), wake_(wake) {}

  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }

  /// Scheduler thread, before the modules: what the lines said last.
  void look(GpioImage& image) const noexcept;
  /// Scheduler thread, after the modules. A change wakes the lines thread: one system call, which does not
  /// wait.
  void want(std::uint32_t levels) noexcept;

  /// Lines thread: every input was read, and these outputs did not take their level.
  void show(std::uint32_t inputs, std::uint32_t unwritten) noexcept;
  /// Lines thread: an input could not be read; what was read before stays, and grows old.
  void showUnread(std::uint32_t unwritten) noexcept;
  /// Lines thread: the lines are not held.
  void showClosed() noexcept { seen_.store(0, std::memory_order_relaxed); }
  /// Lines thread.
  [[nodiscard]] std::uint32_t wanted() const noexcept { return wanted_.load(std::memory_order_relaxed); }

 private:
  // A word of 64 bits: inputs, unwritten outputs, kOpen, and from bit 33 on the count of readings.
  static constexpr unsigned kUnwrittenShift = 16;
  static constexpr std::uint64_t kLines = 0xFFFF;
  static constexpr std::uint64_t kOpen = std::uint64_t{1} << 32U;
  static constexpr unsigned kReadingsShift = 33;

  Settings settings_;
  // Relaxed: each is one word, and says nothing about other memory.
  std::atomic<std::uint64_t> seen_{0};  ///< lines -> scheduler
  std::atomic<std::uint32_t> wanted_;   ///< scheduler -> lines
  int wake_;
};

/// All of a robot.
class LineBanks {
 public:
  [[nodiscard]] static Result<std::unique_ptr<LineBanks>> create(std::vector<LineBank::Settings> banks);

  [[nodiscard]] std::size_t size() const noexcept { return banks_.size(); }
  [[nodiscard]] LineBank& operator[](std::size_t index) noexcept { return *banks_[index]; }
  /// An eventfd: an output is wanted otherwise.
  [[nodiscard]] int wake() const noexcept { return wake_.get(); }

 private:
  explicit LineBanks(UniqueFd wake) noexcept : wake_(std::move(wake)) {}

  UniqueFd wake_;
  std::vector<std::unique_ptr<LineBank>> banks_;
};

}  // namespace rc10
