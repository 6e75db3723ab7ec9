#include "gripper.hpp"

#include <array>
#include <cmath>

namespace shop {
namespace {

using namespace rc10;
using enum OwnKey::Kind;

// 1. The keys: strict, with a unit, a range and a sentence for people.
constexpr std::array kKeys{
    OwnKey{.name = "motor", .kind = kMotor, .required = true, .about = "The motor; positive closes."},
    OwnKey{.name = "grip_a",
           .kind = kNumber,
           .unit = "A",
           .max = 20,
           .above_min = true,
           .default_text = "1",
           .about = "Current that closes and holds."},
    OwnKey{.name = "still_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 20,
           .max = 5000,
           .default_text = "100",
           .about = "Not moving for so long while it closes: it holds something."}};

// 2. What it takes, gives and reports.
enum Input : std::size_t { kClose };
enum Output : std::size_t { kHolding };
enum EventPlace : std::size_t { kGripped };

ModuleSignals gripperSignals() {
  return {.inputs = {"close"},
          .outputs = {"holding"},
          .events = {{.text = "it holds something", .expected = true}}};
}

// 3. What it does in every tick, before the motors. Nothing here allocates, waits or throws.
class Gripper : public Module_Base {
 public:
  explicit Gripper(const OwnValues& own)
      : Module_Base(gripperSignals()),
        motor_(own.motor("motor")),
        grip_a_(own.number("grip_a")),
        still_(std::chrono::milliseconds{own.integer("still_ms")}) {}

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    const bool close = commanded() && input(kClose) >= 0.5;
    const bool moves = std::fabs(robot.feedback(motor_).velocity_rpm) > 1.0F;
    if (!close || moves || !robot.obeys(motor_)) moved_ = tick.now;
    const bool holding = tick.now - moved_ >= still_;
    if (holding && !holding_) robot.report(kGripped);
    holding_ = holding;
    setOutput(kHolding, holding ? 1.0 : 0.0);
    // Without a command nothing is asked: the motor falls back as its on_timeout says.
    if (commanded())
      robot.setTarget(motor_, {.mode = ControlMode::kCurrent, .value = close ? grip_a_ : -grip_a_});
  }

 private:
  std::size_t motor_;
  double grip_a_;
  Duration still_;
  MonotonicTime moved_{};
  bool holding_ = false;
};

// 4. Its type: a name, a sentence, and how to build one. What cannot work is said here, before the start.
class GripperType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "gripper"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "Closes until it holds something.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kKeys; }
  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    if (auto able = robot.require(ControlMode::kCurrent, settings.own.motor("motor"), "motor"); !able)
      return tl::unexpected(able.error());
    return std::make_unique<Gripper>(settings.own);
  }
};

}  // namespace

const ModuleType& gripperType() noexcept {
  static const GripperType kType;
  return kType;
}

}  // namespace shop
