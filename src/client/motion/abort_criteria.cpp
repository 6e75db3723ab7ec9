#include "client/motion/abort_criteria.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include "client/quantity_text.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

constexpr std::array kCriterionWords{"angle",     "velocity", "current",    "feedback_age", "limit",
                                     "ownership", "status",   "connection", "interrupted",  "silence"};

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

Abort beyond(Criterion criterion, double value, double limit, const char* unit, const std::string& reading,
             const std::string& remedy) {
  const bool known = !std::isnan(value);
  return {criterion, value, limit, unit,
          reading +
              (known ? " " + quantity(value, 2, unit) + " beyond " + quantity(limit, 2, unit)
                     : " is not reported, and has a limit of " + quantity(limit, 2, unit)) +
              ": " + remedy};
}

}  // namespace

const char* toString(Criterion criterion) noexcept {
  return kCriterionWords[static_cast<std::size_t>(criterion)];
}

Result<void> admits(const AbortCriteria& criteria, const Excitation& excitation, ControlMode mode) {
  if (measuredMember(mode) == nullptr)
    return fail(std::string("no reading follows a target of mode ") + toString(mode) +
                ": use velocity, total_angle or current");
  if (!(criteria.current_max_a > 0.0)) return fail("the current has no limit: give one above 0, such as 3 A");
  if (!(criteria.velocity_max_rpm > 0.0)) return fail("the speed has no limit: give one above 0 rpm");
  if (!(criteria.angle_min_deg <= 0.0 && criteria.angle_max_deg >= 0.0))
    return fail(
        "the motor stands outside of its corridor: the lowest angle is 0 or below, the highest 0 or "
        "above; both count from where it stands");
  if (!(criteria.feedback_age_max_us > 0.0))
    return fail("the age of feedback has no limit: give one above 0");
  const double low = excitation.lowest();
  const double high = excitation.highest();
  const auto leaves = [&](double least, double most, const char* unit, const char* remedy) -> Result<void> {
    if (low >= least && high <= most) return {};
    return fail("the target goes from " + number(low, 2) + " to " + quantity(high, 2, unit) +
                ", beyond its limits of " + number(least, 2) + " to " + quantity(most, 2, unit) + ": " +
                remedy);
  };
  if (mode == ControlMode::kTotalAngle)
    return leaves(criteria.angle_min_deg, criteria.angle_max_deg, "deg",
                  "a smaller amplitude, or a wider corridor");
  if (mode == ControlMode::kVelocity)
    return leaves(-criteria.velocity_max_rpm, criteria.velocity_max_rpm, "rpm",
                  "a smaller amplitude, or a higher limit of the speed");
  return leaves(-criteria.current_max_a, criteria.current_max_a, "A",
                "a smaller amplitude, or a higher limit of the current");
}

// Written so that a reading that is not there meets no limit.
std::optional<Abort> judge(const AbortCriteria& criteria, const CurveSample& sample, double start_deg) {
  if (!(sample.feedback_age_us >= 0.0 && sample.feedback_age_us <= criteria.feedback_age_max_us))
    return beyond(Criterion::kFeedbackAge, sample.feedback_age_us / 1000.0,
                  criteria.feedback_age_max_us / 1000.0, "ms", "feedback age",
                  "check the wiring and the load of its bus (`rc10ctl stats`)");
  const double turned_deg = sample.total_angle_deg - start_deg;
  const bool corridor = std::isfinite(criteria.angle_min_deg) || std::isfinite(criteria.angle_max_deg);
  if (corridor && !(turned_deg >= criteria.angle_min_deg && turned_deg <= criteria.angle_max_deg))
    return beyond(Criterion::kAngle, turned_deg,
                  turned_deg < criteria.angle_min_deg ? criteria.angle_min_deg : criteria.angle_max_deg,
                  "deg", "angle from the start", "a smaller amplitude, lower gains, or a wider corridor");
  if (std::isfinite(criteria.velocity_max_rpm) &&
      !(std::abs(sample.velocity_rpm) <= criteria.velocity_max_rpm))
    return beyond(Criterion::kVelocity, sample.velocity_rpm,
                  std::copysign(criteria.velocity_max_rpm, sample.velocity_rpm), "rpm", "speed",
                  "a smaller amplitude, lower gains, or a higher limit of the speed");
  if (std::isfinite(criteria.current_max_a) && !(std::abs(sample.current_a) <= criteria.current_max_a))
    return beyond(Criterion::kCurrent, sample.current_a,
                  std::copysign(criteria.current_max_a, sample.current_a), "A", "current",
                  "a smaller amplitude, lower gains, or a higher limit of the current");
  if (criteria.limits_abort && sample.limits != 0)
    return Abort{Criterion::kLimit, kNoNumber, kNoNumber, "",
                 "the motor's limit acts (" + link::limitWords(sample.limits) +
                     "): a smaller amplitude, or let limits act"};
  return std::nullopt;
}

}  // namespace rc10::client
