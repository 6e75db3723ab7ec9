#include "client/motion/motion_plan.hpp"

#include <algorithm>
#include <cmath>

namespace rc10::client {
namespace {

// Share of the amplitude beside the target that the angle and the speed of a sound loop may take.
constexpr double kRoom = 0.5;
constexpr double kStepS = 1.5;
// Ten periods give a mean of nine segments.
constexpr double kPeriods = 10.0;
constexpr double kSinesS = 10.0;

constexpr std::int32_t kLeastDeadManMs = 20;
constexpr std::int32_t kMostDeadManMs = 1000;

double defaultTimeS(const MotionPlan& plan) {
  const bool sines = plan.kind == ExcitationKind::kSweep || plan.kind == ExcitationKind::kMultisine;
  return sines ? std::min(std::max(kSinesS, kPeriods / plan.from_hz), Excitation::kLongestS) : kStepS;
}

Result<AbortCriteria> criteriaOf(const MotionPlan& plan, const Excitation& excitation) {
  AbortCriteria criteria;
  criteria.current_max_a = plan.max_current_a;
  criteria.feedback_age_max_us = plan.max_feedback_age_s * 1e6;
  criteria.limits_abort = plan.stop_at_limits;
  const double room = kRoom * std::abs(plan.amplitude);
  if (plan.mode == ControlMode::kVelocity) {
    criteria.velocity_max_rpm = std::max(-excitation.lowest(), excitation.highest()) + room;
  } else if (!plan.max_speed_rpm) {
    return fail(std::string("a test in mode ") + toString(plan.mode) +
                " needs a limit of the speed: beyond it the motor is let go");
  }
  if (plan.mode == ControlMode::kTotalAngle) {
    criteria.angle_min_deg = excitation.lowest() - room;
    criteria.angle_max_deg = excitation.highest() + room;
  }
  criteria.velocity_max_rpm = plan.max_speed_rpm.value_or(criteria.velocity_max_rpm);
  criteria.angle_min_deg = plan.min_angle_deg.value_or(criteria.angle_min_deg);
  criteria.angle_max_deg = plan.max_angle_deg.value_or(criteria.angle_max_deg);
  return criteria;
}

}  // namespace

Result<MotionSettings> settingsOf(const MotionPlan& plan, const std::string& client) {
  if (plan.rate_per_s && plan.kind != ExcitationKind::kRamp)
    return fail(std::string("a rate is for a ramp, not for a ") + toString(plan.kind) + ": leave it out");
  if (plan.dead_man_ms < kLeastDeadManMs || plan.dead_man_ms > kMostDeadManMs)
    return fail("a silence of " + std::to_string(plan.dead_man_ms) + " ms: give " +
                std::to_string(kLeastDeadManMs) + " to " + std::to_string(kMostDeadManMs) + " ms");
  const ExcitationSettings shape{.kind = plan.kind,
                                 .base = plan.base,
                                 .amplitude = plan.amplitude,
                                 .time_s = plan.time_s.value_or(defaultTimeS(plan)),
                                 .rate_per_s = plan.rate_per_s.value_or(0.0),
                                 .from_hz = plan.from_hz,
                                 .to_hz = plan.to_hz,
                                 .linear = plan.linear};
  const auto excitation = Excitation::of(shape);
  if (!excitation) return tl::unexpected(excitation.error());
  const auto criteria = criteriaOf(plan, *excitation);
  if (!criteria) return tl::unexpected(criteria.error());
  if (const auto fit = admits(*criteria, *excitation, plan.mode); !fit) return tl::unexpected(fit.error());
  return MotionSettings{.client = client,
                        .motor = plan.motor,
                        .mode = plan.mode,
                        .excitation = shape,
                        .criteria = *criteria,
                        .validity_ms = plan.dead_man_ms};
}

}  // namespace rc10::client
