#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/motion_match.hpp"
#include "app/planar_motion.hpp"
#include "app/planar_odometry.hpp"
#include "app/slew_limiter.hpp"
#include "module/module_base.hpp"
#include "module/module_type.hpp"
#include "module/power_limiter.hpp"
#include "motor/own_key.hpp"
#include "motor/own_values.hpp"

namespace rc10 {

/// Common part of every chassis, whatever its wheels: takes a twist in one of three frames, keeps it within
/// speed, acceleration and power, hands it to the wheels, and says where the robot has got to. A user's
/// chassis of another kind is a subclass. All wheels drive or none: while one of them is not there, the
/// others fall back.
class Chassis_Base : public Module_Base {
 public:
  /// The keys that every chassis has; a type's own come behind them.
  [[nodiscard]] static std::span<const OwnKey> commonKeys() noexcept;

  /// `own` has the values of commonKeys(); `motors` are all that it drives.
  Chassis_Base(const OwnValues& own, std::vector<std::size_t> motors);

  [[nodiscard]] Result<void> connect(const ModuleDirectory& others) override;
  void update(const Tick& tick, ModuleRobot& robot) noexcept final;

 protected:
  /// Whether it can be driven now, beside all its motors obeying.
  [[nodiscard]] virtual bool ready(const ModuleRobot&) const noexcept { return true; }
  /// Whether it can; else vy_m_s does nothing.
  [[nodiscard]] virtual bool drivesSideways() const noexcept { return true; }
  /// Sets the targets of all motors for a motion in the robot's frame. No wheel may get more than it can do:
  /// the direction of the motion is kept.
  virtual void drive(const Twist2D& body, ModuleRobot& robot) noexcept = 0;
  /// The motion by the wheels' velocities.
  [[nodiscard]] virtual Twist2D measured(const ModuleRobot& robot) const noexcept = 0;
  /// The mean motion since the last call, by the wheels' multi-turn angles; called in every tick. NaN where
  /// it is not known.
  [[nodiscard]] virtual Twist2D travelled(const ModuleRobot& robot, float dt_s) noexcept = 0;

 private:
  [[nodiscard]] bool allObey(const ModuleRobot& robot) const noexcept;
  [[nodiscard]] bool allFresh(const Tick& tick, const ModuleRobot& robot) const noexcept;
  [[nodiscard]] Twist2D wanted(const ModuleRobot& robot) const noexcept;
  [[nodiscard]] double shareOf(const Twist2D& wanted, const Twist2D& part) const noexcept;
  [[nodiscard]] Twist2D bounded(Twist2D twist) const noexcept;
  void updateOdometry(const Tick& tick, ModuleRobot& robot) noexcept;
  [[nodiscard]] double trustedHeading(const Twist2D& way, const Tick& tick, ModuleRobot& robot) noexcept;
  [[nodiscard]] double power(const ModuleRobot& robot) const noexcept;

  std::vector<std::size_t> motors_;
  double max_speed_m_s_;
  double max_turn_deg_s_;
  double follow_gain_per_s_;
  double loss_w_per_nm2_;
  std::string heading_name_;
  std::string follow_name_;
  std::optional<SignalPlace> heading_;
  std::optional<SignalPlace> follow_;
  std::optional<SignalPlace> turn_after_;  ///< That angle, while turning brings it nearer.
  TwistSlewLimiter slew_;
  bool begun_ = false;  ///< slew_ goes on from a motion that was measured.
  PlanarOdometry odometry_;
  MotionMatch heading_match_;
  double wheels_heading_deg_ = 0.0;
  bool heading_opposed_ = false;
  bool was_active_ = false;  ///< All motors.
  PowerLimiter power_;
};

/// A type of chassis: its motors stop together, but each may be enabled alone.
class ChassisType : public ModuleType {
 public:
  [[nodiscard]] Coupling coupling() const noexcept override { return Coupling::kStop; }
};

}  // namespace rc10
