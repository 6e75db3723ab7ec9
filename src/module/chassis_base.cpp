#include "module/chassis_base.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/angle.hpp"
#include "app/limits.hpp"
#include "app/units.hpp"
#include "module/module_type.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

// Wheels whose feedback is older say nothing about the motion.
constexpr Duration kFresh = std::chrono::milliseconds{100};

constexpr std::array kChassisKeys{
    OwnKey{.name = "max_speed_m_s",
           .kind = kNumber,
           .unit = "m/s",
           .max = 100,
           .above_min = true,
           .required = true,
           .about = "Bound of the velocity, in every direction."},
    OwnKey{.name = "max_turn_deg_s",
           .kind = kNumber,
           .unit = "deg/s",
           .max = 100'000,
           .above_min = true,
           .required = true,
           .about = "Bound of the turn rate."},
    OwnKey{.name = "max_acceleration_m_s2",
           .kind = kNumber,
           .unit = "m/s^2",
           .max = 1000,
           .above_min = true,
           .required = true,
           .about = "How fast the velocity that the wheels are told may change; as a vector, so that the "
                    "path is not bent."},
    OwnKey{.name = "max_turn_acceleration_deg_s2",
           .kind = kNumber,
           .unit = "deg/s^2",
           .max = 1'000'000,
           .above_min = true,
           .required = true,
           .about = "How fast the turn rate may change."},
    OwnKey{.name = "heading",
           .kind = kText,
           .about =
               "The output of another module that is the robot's heading in deg: for twists in the world's "
               "frame and for odometry. Default: the odometry's own.",
           .pattern = kSignalPattern,
           .words = kSignalWords},
    OwnKey{.name = "follow",
           .kind = kText,
           .about =
               "The output of another module that is the angle of a gimbal to the front of the chassis, deg: "
               "for twists in the gimbal's frame, and for turning after it.",
           .pattern = kSignalPattern,
           .words = kSignalWords},
    OwnKey{.name = "follow_gain_per_s",
           .kind = kNumber,
           .unit = "1/s",
           .max = 100,
           .default_text = "5",
           .about = "How fast it turns after the gimbal: deg/s for each degree."},
    OwnKey{.name = "power_limit_w",
           .kind = kNumber,
           .unit = "W",
           .max = 100'000,
           .default_text = "0",
           .about = "The motion is slowed while the wheels take more: torque times speed, plus "
                    "loss_w_per_nm2. 0: no limit."},
    OwnKey{.name = "loss_w_per_nm2",
           .kind = kNumber,
           .unit = "W/Nm^2",
           .max = 1000,
           .default_text = "0",
           .about = "Heat in the windings, for power_limit_w: W for each Nm squared of each wheel."}};

enum ChassisInput : std::size_t { kVx, kVy, kWz, kFrame, kTurnAfter, kX, kY, kHeading };
enum ChassisOutput : std::size_t { kOutX, kOutY, kOutHeading, kOutVx, kOutVy, kOutWz, kOutPower, kOutFactor };

enum ChassisEvent : std::size_t { kHeadingOpposed };

// Three degrees within a tenth of a second; less than that where it turns faster.
constexpr MotionMatch::Config kHeadingMatch{.enough = 0.02, .circular_period = kDegPerTurn};

ModuleSignals chassisSignals() {
  return {.inputs = {"vx_m_s", "vy_m_s", "wz_deg_s", "frame", "follow", "x_m", "y_m", "heading_deg"},
          .outputs = {"x_m", "y_m", "heading_deg", "vx_m_s", "vy_m_s", "wz_deg_s", "power_w", "power_factor"},
          .events = {{.text = "heading turns against the wheels and is not used: the odometry's own is; see "
                              "the sensor's mounting and the direction of the wheels"}}};
}

Result<void> find(std::optional<SignalPlace>& place, const std::string& name, const char* key,
                  const ModuleDirectory& others) {
  if (name.empty()) return {};
  auto found = others.findOutput(name);
  if (!found) return fail(std::string{key} + ": " + found.error().message);
  place = *found;
  return {};
}

}  // namespace

std::span<const OwnKey> Chassis_Base::commonKeys() noexcept { return kChassisKeys; }

Chassis_Base::Chassis_Base(const OwnValues& own, std::vector<std::size_t> motors)
    : Module_Base(chassisSignals()),
      motors_(std::move(motors)),
      max_speed_m_s_(own.number("max_speed_m_s")),
      max_turn_deg_s_(own.number("max_turn_deg_s")),
      follow_gain_per_s_(own.number("follow_gain_per_s")),
      loss_w_per_nm2_(own.number("loss_w_per_nm2")),
      heading_name_(own.text("heading")),
      follow_name_(own.text("follow")),
      slew_({.linear_m_s2 = own.number("max_acceleration_m_s2"),
             .angular_deg_s2 = own.number("max_turn_acceleration_deg_s2")}),
      heading_match_(kHeadingMatch),
      power_(own.number("power_limit_w")) {}

Result<void> Chassis_Base::connect(const ModuleDirectory& others) {
  if (auto found = find(heading_, heading_name_, "heading", others); !found) return found;
  if (auto found = find(follow_, follow_name_, "follow", others); !found) return found;
  // A gimbal says apart from that when it may be turned after.
  turn_after_ = follow_;
  const auto module = follow_name_.substr(0, follow_name_.find('.'));
  if (const auto own = others.findOutput(module + ".turn_after_deg")) turn_after_ = *own;
  return {};
}

void Chassis_Base::update(const Tick& tick, ModuleRobot& robot) noexcept {
  updateOdometry(tick, robot);
  const bool fresh = allFresh(tick, robot);
  const Twist2D now = fresh ? measured(robot) : Twist2D{};
  const double power_w = fresh ? power(robot) : kNoSignal;
  const Twist2D twist = commanded() ? bounded(wanted(robot)) : Twist2D{};
  const double factor = power_.step(
      power_w, {.told = shareOf(twist, slew_.value()), .measured = shareOf(twist, now)}, tick.dt_s);
  setOutput(kOutVx, fresh ? now.vx_m_s : kNoSignal);
  setOutput(kOutVy, fresh ? now.vy_m_s : kNoSignal);
  setOutput(kOutWz, fresh ? now.wz_deg_s : kNoSignal);
  setOutput(kOutPower, power_w);
  setOutput(kOutFactor, factor);
  // A command begins with the present motion: a robot that rolls is not stopped in a jump. Until that is
  // heard it waits.
  const bool drives = commanded() && allObey(robot) && ready(robot);
  if (!drives || !begun_) {
    begun_ = fresh;
    slew_.reset(finiteOrRest(now));
  }
  if (!drives || !begun_) return;
  drive(slew_.step({.vx_m_s = twist.vx_m_s * factor,
                    .vy_m_s = twist.vy_m_s * factor,
                    .wz_deg_s = twist.wz_deg_s * factor},
                   tick.dt_s),
        robot);
}

Twist2D Chassis_Base::wanted(const ModuleRobot& robot) const noexcept {
  Twist2D twist{
      .vx_m_s = finiteOr0(input(kVx)), .vy_m_s = finiteOr0(input(kVy)), .wz_deg_s = finiteOr0(input(kWz))};
  const double gimbal_deg = follow_ ? robot.read(*follow_) : kNoSignal;
  const double frame = std::trunc(finiteOr0(input(kFrame)));
  if (frame == 1.0) {
    twist = worldToBody(twist, odometry_.pose().heading_deg);
  } else if (frame == 2.0) {
    // The gimbal's angle is not known: no motion is better than one in a wrong direction.
    if (!std::isfinite(gimbal_deg)) return {};
    twist = seenFrom(-gimbal_deg, twist);
  }
  const double turn_after_deg = turn_after_ ? robot.read(*turn_after_) : kNoSignal;
  if (finiteOr0(input(kTurnAfter)) >= 0.5 && std::isfinite(turn_after_deg))
    twist.wz_deg_s += follow_gain_per_s_ * wrapHalfTurn(turn_after_deg);
  if (!drivesSideways()) twist.vy_m_s = 0.0;
  return twist;
}

// Projection of `part` on `wanted`; speed and turning count as shares of their limits.
double Chassis_Base::shareOf(const Twist2D& wanted, const Twist2D& part) const noexcept {
  const double per_speed = max_speed_m_s_ > 0.0 ? 1.0 / (max_speed_m_s_ * max_speed_m_s_) : 0.0;
  const double per_turn = max_turn_deg_s_ > 0.0 ? 1.0 / (max_turn_deg_s_ * max_turn_deg_s_) : 0.0;
  const auto product = [&](const Twist2D& a, const Twist2D& b) noexcept {
    return (a.vx_m_s * b.vx_m_s + a.vy_m_s * b.vy_m_s) * per_speed + a.wz_deg_s * b.wz_deg_s * per_turn;
  };
  const double whole = product(wanted, wanted);
  return whole > 0.0 ? product(wanted, part) / whole : 0.0;
}

Twist2D Chassis_Base::bounded(Twist2D twist) const noexcept {
  const double speed_m_s = std::hypot(twist.vx_m_s, twist.vy_m_s);
  if (speed_m_s > max_speed_m_s_) {
    twist.vx_m_s *= max_speed_m_s_ / speed_m_s;
    twist.vy_m_s *= max_speed_m_s_ / speed_m_s;
  }
  twist.wz_deg_s = std::clamp(twist.wz_deg_s, -max_turn_deg_s_, max_turn_deg_s_);
  return twist;
}

void Chassis_Base::updateOdometry(const Tick& tick, ModuleRobot& robot) noexcept {
  // While a wheel is not heard, no way is counted; that of the others counts once it is back.
  if (allFresh(tick, robot)) {
    const Twist2D way = travelled(robot, tick.dt_s);
    odometry_.step(way, trustedHeading(way, tick, robot), tick.dt_s);
  }
  if (commanded()) {
    Pose2D pose = odometry_.pose();
    if (std::isfinite(input(kX))) pose.x_m = input(kX);
    if (std::isfinite(input(kY))) pose.y_m = input(kY);
    if (std::isfinite(input(kHeading))) pose.heading_deg = input(kHeading);
    if (pose != odometry_.pose()) odometry_.reset(pose);
  }
  setOutput(kOutX, odometry_.pose().x_m);
  setOutput(kOutY, odometry_.pose().y_m);
  setOutput(kOutHeading, odometry_.pose().heading_deg);
}

// A heading of the wrong sign would turn every twist of the world's frame the wrong way. The first turn shows
// it. While the motors are disabled a person may mount the sensor anew: one that agreed is compared again.
// One that did not stays out: to believe it until the next turn would turn the heading about.
double Chassis_Base::trustedHeading(const Twist2D& way, const Tick& tick, ModuleRobot& robot) noexcept {
  const bool active = std::all_of(motors_.begin(), motors_.end(), [&](std::size_t motor) {
    return robot.status(motor) == MotorStatus::kActive;
  });
  if (std::exchange(was_active_, active) != active && !heading_opposed_) heading_match_.reset();
  const double heading_deg = heading_ ? robot.read(*heading_) : kNoSignal;
  if (std::isfinite(way.wz_deg_s)) wheels_heading_deg_ += way.wz_deg_s * static_cast<double>(tick.dt_s);
  heading_match_.step(wheels_heading_deg_, heading_deg, tick.dt_s);
  const bool opposed = heading_match_.sign() == MotionMatch::Sign::kOpposed;
  if (opposed && !heading_opposed_) robot.report(kHeadingOpposed);
  heading_opposed_ = opposed;
  return opposed ? kNoSignal : heading_deg;
}

bool Chassis_Base::allObey(const ModuleRobot& robot) const noexcept {
  return std::all_of(motors_.begin(), motors_.end(), [&](std::size_t motor) { return robot.obeys(motor); });
}

bool Chassis_Base::allFresh(const Tick& tick, const ModuleRobot& robot) const noexcept {
  return std::all_of(motors_.begin(), motors_.end(), [&](std::size_t motor) {
    const auto& feedback = robot.feedback(motor);
    return feedback.samples > 0 && tick.now - feedback.received <= kFresh;
  });
}

// Mechanical power that the wheels take, and what heats their windings. Braking gives nothing back.
double Chassis_Base::power(const ModuleRobot& robot) const noexcept {
  double power_w = 0.0;
  for (const auto motor : motors_) {
    const auto& feedback = robot.feedback(motor);
    const double torque_nm = static_cast<double>(feedback.torque_nm);
    const double speed_rad_s = static_cast<double>(feedback.velocity_rpm) * kRadPerSPerRpm;
    power_w += std::max(0.0, torque_nm * speed_rad_s) + loss_w_per_nm2_ * torque_nm * torque_nm;
  }
  return power_w;
}

}  // namespace rc10
