#include "module/feeder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "app/units.hpp"
#include "app/watched_time.hpp"
#include "module/module_robot.hpp"
#include "module/travel_of_motors.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

// Share of the velocity that is asked for: slower than this it does not move.
constexpr double kMoves = 0.2;
// More than any magazine holds: a count that leaps farther is a mistake of its sender.
constexpr double kMostShots = 1000.0;

constexpr std::array kFeederKeys{
    OwnKey{
        .name = "motor", .kind = kMotor, .required = true, .about = "The motor; it needs velocity targets."},
    OwnKey{.name = "velocity_limit_rpm",
           .kind = kNumber,
           .unit = "rpm",
           .max = 100'000,
           .above_min = true,
           .required = true,
           .about = "Bound of velocity targets; single shots are fed at this velocity."},
    OwnKey{.name = "deg_per_shot",
           .kind = kNumber,
           .unit = "deg",
           .max = 3600,
           .above_min = true,
           .default_text = "45",
           .about = "Turn of the output shaft for one shot: 360 divided by the number of pockets."},
    OwnKey{.name = "jam_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 10,
           .max = 5000,
           .default_text = "200",
           .about = "Standing still for this time while it should move is a jam. Must be shorter than the "
                    "motor's stall_ms."},
    OwnKey{.name = "reverse_rpm",
           .kind = kNumber,
           .unit = "rpm",
           .max = 100'000,
           .above_min = true,
           .default_text = "30",
           .about = "Velocity backwards, to free a jam."},
    OwnKey{.name = "reverse_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 10,
           .max = 5000,
           .default_text = "200",
           .about = "Time for which it turns backwards."},
    OwnKey{.name = "retries",
           .kind = kInteger,
           .max = 100,
           .default_text = "3",
           .about = "Number of new tries in a row; then it gives up until the request ends."}};

ModuleSignals feederSignals() {
  return {.inputs = {"velocity_rpm", "shots"},
          .outputs = {"state", "shots_left", "jams"},
          .events = {{.text = "jammed: goes back and tries again"},
                     {.text = "free again", .expected = true},
                     {.text = "jammed, and no way back frees it: it rests until nobody asks any more"}}};
}

class Feeder : public Module_Base {
 public:
  explicit Feeder(const OwnValues& own)
      : Module_Base(feederSignals()),
        motor_(own.motor("motor")),
        limit_rpm_(own.number("velocity_limit_rpm")),
        travel_(1, limit_rpm_),
        deg_per_shot_(own.number("deg_per_shot")),
        jam_s_(static_cast<double>(own.integer("jam_ms")) * 1e-3),
        reverse_rpm_(std::min(own.number("reverse_rpm"), limit_rpm_)),
        reverse_time_(std::chrono::milliseconds{own.integer("reverse_ms")}),
        retries_(own.integer("retries")) {
    show();
  }

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    const auto& feedback = robot.feedback(motor_);
    countShots(feedback, tick.dt_s);
    const double wanted_rpm = wanted(robot);
    if (wanted_rpm == 0.0) {
      // Nobody asks: what was wrong is over, and is found anew if it is not.
      state_ = State::kIdle;
      in_a_row_ = 0;
      if (robot.obeys(motor_) && commanded()) turn(robot, 0.0);
    } else {
      feed(wanted_rpm, static_cast<double>(feedback.velocity_rpm), tick, robot);
    }
    show();
  }

 private:
  enum Input : std::size_t { kVelocityRpm, kShots };
  enum Output : std::size_t { kState, kShotsLeft, kJams };
  enum EventPlace : std::size_t { kJammed, kFreed, kGaveUp };

  enum class State { kIdle, kFeeding, kReversing, kGivenUp };

  /// 0: nothing is asked, or nothing can be done.
  [[nodiscard]] double wanted(ModuleRobot& robot) noexcept {
    if (!commanded() || !robot.obeys(motor_)) {
      // Shots that nobody can fire now must not be fired later.
      shots_left_deg_ = 0.0;
      return 0.0;
    }
    const double limit_rpm = limitRpm(robot);
    if (shots_left_deg_ > 0.0) return limit_rpm;
    const double velocity_rpm = input(kVelocityRpm);
    return std::isfinite(velocity_rpm) ? std::clamp(velocity_rpm, -limit_rpm, limit_rpm) : 0.0;
  }

  // A motor that reduced mode slows is not jammed.
  [[nodiscard]] double limitRpm(const ModuleRobot& robot) const noexcept {
    return std::min(limit_rpm_, robot.speedCeilingRpm(motor_));
  }

  // `shots` is a count: each step up fires one. Its first value fires nothing.
  void countShots(const MotorFeedback& feedback, float dt_s) noexcept {
    const double turned_deg = travel_.meanRpm(0, feedback, dt_s) * kDegPerSPerRpm * static_cast<double>(dt_s);
    if (std::isfinite(turned_deg) && shots_left_deg_ > 0.0)
      shots_left_deg_ = std::max(0.0, shots_left_deg_ - turned_deg);
    // Each sender has a count of its own.
    if (std::exchange(counted_for_, senderCount()) != senderCount()) {
      last_shots_ = kNoSignal;
      shots_left_deg_ = 0.0;
    }
    const double shots = commanded() ? input(kShots) : kNoSignal;
    if (std::isfinite(shots) && std::isfinite(last_shots_) && shots > last_shots_)
      shots_left_deg_ = std::min(shots_left_deg_ + std::min(shots - last_shots_, kMostShots) * deg_per_shot_,
                                 kMostShots * deg_per_shot_);
    last_shots_ = shots;
  }

  void feed(double wanted_rpm, double measured_rpm, const Tick& tick, ModuleRobot& robot) noexcept {
    switch (state_) {
      case State::kIdle:
        state_ = State::kFeeding;
        still_.restart();
        break;
      case State::kFeeding: watchJam(wanted_rpm, measured_rpm, tick, robot); break;
      case State::kReversing:
        if (tick.now < reverse_until_) break;
        state_ = State::kFeeding;
        still_.restart();
        break;
      case State::kGivenUp: break;
    }
    switch (state_) {
      case State::kReversing:
        return turn(robot, std::copysign(std::min(reverse_rpm_, limitRpm(robot)), -wanted_rpm));
      case State::kGivenUp: return turn(robot, 0.0);
      default: return turn(robot, wanted_rpm);
    }
  }

  void watchJam(double wanted_rpm, double measured_rpm, const Tick& tick, ModuleRobot& robot) noexcept {
    still_.step(tick);
    freed_.step(tick);
    if (measured_rpm * std::copysign(1.0, wanted_rpm) >= kMoves * std::fabs(wanted_rpm)) {
      // It has to go on for as long as a jam lasts before it counts as freed: a ball gives a little.
      if (in_a_row_ > 0 && freed_.seconds() >= 2 * jam_s_) {
        in_a_row_ = 0;
        robot.report(kFreed);
      }
      still_.restart();
      return;
    }
    if (still_.seconds() < jam_s_) return;
    ++jams_;
    if (++in_a_row_ > retries_) {
      state_ = State::kGivenUp;
      robot.report(kGaveUp);
      return;
    }
    if (in_a_row_ == 1) robot.report(kJammed);
    state_ = State::kReversing;
    reverse_until_ = tick.now + reverse_time_;
    freed_.restart();
  }

  void turn(ModuleRobot& robot, double velocity_rpm) const noexcept {
    robot.setTarget(motor_, {.mode = ControlMode::kVelocity, .value = velocity_rpm});
  }

  void show() noexcept {
    setOutput(kState, static_cast<double>(state_));
    setOutput(kShotsLeft, std::ceil(shots_left_deg_ / deg_per_shot_));
    setOutput(kJams, static_cast<double>(jams_));
  }

  std::size_t motor_;
  double limit_rpm_;
  TravelOfMotors travel_;
  double deg_per_shot_;
  double jam_s_;
  double reverse_rpm_;
  Duration reverse_time_;
  int retries_;

  State state_ = State::kIdle;
  double shots_left_deg_ = 0.0;
  double last_shots_ = kNoSignal;
  std::uint32_t counted_for_ = 0;  ///< The sender of last_shots_.
  int in_a_row_ = 0;               ///< Jams without a success between them.
  long jams_ = 0;
  MonotonicTime reverse_until_{};
  WatchedTime still_;  ///< Since it moved as it is told.
  WatchedTime freed_;  ///< Time of feeding since the last jam.
};

class FeederType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "feeder"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "Pushes balls or discs forward; frees itself when it is jammed.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kFeederKeys; }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    if (auto able = robot.require(ControlMode::kVelocity, settings.own.motor("motor"), "motor"); !able)
      return tl::unexpected(able.error());
    return std::make_unique<Feeder>(settings.own);
  }
};

}  // namespace

const ModuleType& feederType() noexcept {
  static const FeederType kType;
  return kType;
}

}  // namespace rc10
