#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"
#include "bus/can_frame.hpp"
#include "sim/drive.hpp"
#include "sim/load_change.hpp"

namespace rc10::sim {

/// Factory of one drive, for any number of calls. The error names the drive and the fix.
using DriveRecipe = std::function<Result<std::unique_ptr<Drive>>()>;

/// Drives and properties of one simulated bus.
struct SimBusConfig {
  std::vector<DriveRecipe> drives;
  std::vector<LoadPlan> plans;  ///< By place of the drive; further drives have none.
  std::uint64_t seed = 1;
  /// Drive n starts to talk up to this much later than the first, by the seed: at most a quarter
  /// of the feedback period. Shows only in steps that are shorter still.
  Duration phase_spread{};
};

/// The drives of one bus, and what goes wrong with them. One thread; identical seeds, steps and frames
/// give bit-identical feedback. Nothing allocates after construction.
class SimBus {
 public:
  /// A step gives out no more than this many frames: room for what every drive answers and sends.
  static constexpr std::size_t kMaxFramesPerStep = 256;

  struct Counters {
    std::uint64_t feedback = 0;    ///< Frames given out.
    std::uint64_t lost = 0;        ///< Lost on purpose: lost_frames, silent.
    std::uint64_t overslept = 0;   ///< Never made, because a step was longer than the feedback period.
    std::uint64_t overflowed = 0;  ///< Did not fit into `out`.
  };

  /// Every problem a drive can have, and two drives that would send the same id.
  [[nodiscard]] static Result<void> check(const SimBusConfig& config);

  /// `config` has passed check().
  explicit SimBus(const SimBusConfig& config);

  /// A frame that some node put on the bus: every drive sees it.
  void receive(const CanFrame& command) noexcept;

  /// Advances to `now`, which is `dt` after the step before. Every drive answers what it received, and whose
  /// turn it is sends its state at `now`; out.size() of kMaxFramesPerStep holds all. A step longer than the
  /// feedback period gives that state once, not several times: frames written together carry one receive
  /// stamp, and stamps that do not belong to the samples would make the receiver count wrong turns. A late
  /// simulator thus looks like a bus that loses frames, which receivers must survive anyway.
  std::size_t step(MonotonicTime now, Duration dt, std::span<CanFrame> out) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }
  [[nodiscard]] std::optional<std::size_t> indexOf(std::string_view name) const noexcept;
  [[nodiscard]] const Drive& drive(std::size_t index) const noexcept { return *nodes_[index].drive; }
  [[nodiscard]] Drive& drive(std::size_t index) noexcept { return *nodes_[index].drive; }
  [[nodiscard]] const MotorPhysics& motor(std::size_t index) const noexcept { return drive(index).physics(); }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

  // Faults, at any time between two steps.
  void setLoad(std::size_t index, const MotorLoad& load) noexcept;        ///< Replaces all faults as well.
  void changeLoad(std::size_t index, const LoadChange& change) noexcept;  ///< Faults stay.
  void stall(std::size_t index, bool stalled) noexcept;
  void silence(std::size_t index, bool silent) noexcept;
  void loseFrames(std::size_t index, float fraction) noexcept;
  void setTemperature(std::size_t index, double temperature_c) noexcept;
  void turnByHand(std::size_t index, const Hand& hand) noexcept;
  void setEncoderFault(std::size_t index, const Drive::EncoderFault& fault) noexcept;

 private:
  struct Node {
    std::unique_ptr<Drive> drive;
    std::mt19937_64 random;  // its own: one drive's faults do not change another's
    Duration next_feedback;  // after the first step began
    MotorLoad at_start;
    LoadPlan plan;
    std::size_t next_change = 0;
    Duration plan_begun{};  // after the first step began
  };

  [[nodiscard]] bool isDue(Node& node) noexcept;
  void followPlan(Node& node) const noexcept;
  [[nodiscard]] static bool losesFrame(Node& node) noexcept;
  void giveOut(Node& node, std::span<const CanFrame> frames, MonotonicTime now, std::span<CanFrame> out,
               std::size_t& count) noexcept;
  template <typename T>
  void change(std::size_t index, T MotorLoad::*field, T value) noexcept;

  std::vector<Node> nodes_;
  Duration elapsed_{};
  Counters counters_;
};

}  // namespace rc10::sim
