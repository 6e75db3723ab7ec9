#include "drives/cubemars/cubemars_motor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/units.hpp"
#include "drives/cubemars/cubemars_family.hpp"
#include "motor/sample_spacing.hpp"

namespace rc10 {
namespace {

// No start-up time is published. Its boot loader and the encoder's start take longer than this.
constexpr Duration kStartUp = std::chrono::milliseconds{100};
constexpr int kCubemarsGapPeriods = 3;  // feedback periods that are no gap
constexpr double kPositionErrorDeg = 1.0;

}  // namespace

CubeMars_Motor::CubeMars_Motor(const MotorSettings& settings, const CubemarsSettings& own)
    : SoloMotor(settings, cubemarsTraits(own), driveTurns(settings, cubemarsTraits(own))),
      own_(own),
      id_(settings.id),
      longest_gap_(std::max(kStartUp, kCubemarsGapPeriods * feedbackPeriod())),
      reach_deg_per_s_(cubemarsFastestRpm(*own.model) * kDegPerSPerRpm) {}

// ---- Feedback

bool CubeMars_Motor::noticeRestart(MonotonicTime received) noexcept {
  if (feedback_.samples == 0 || received - feedback_.received <= longest_gap_) return false;
  loseReference();
  stopped_ = stopped_ || obeying();
  return true;
}

bool CubeMars_Motor::reaches(MonotonicTime received, double drive_deg) const noexcept {
  if (feedback_.samples == 0) return true;
  const Duration apart = longestApart(received - feedback_.received, feedbackPeriod());
  const double reach_deg = reach_deg_per_s_ * static_cast<double>(seconds(apart)) + kPositionErrorDeg;
  return std::fabs(drive_deg - last_drive_deg_) <= reach_deg;
}

void CubeMars_Motor::takePosition(MonotonicTime received, double drive_deg) noexcept {
  if (!reaches(received, drive_deg)) {
    ++feedback_.jumps;
    loseReference();
  }
  last_drive_deg_ = drive_deg;
  acceptSample(received, drive_deg);
}

FrameVerdict CubeMars_Motor::takeServoReport(const CanFrame& frame) noexcept {
  const auto report = cubemars::readServoReport(frame);
  if (!report) return FrameVerdict::kMalformed;
  (void)noticeRestart(frame.received);
  takePosition(frame.received, report->degrees / own_.message_deg_per_deg);
  // At the end of the field nobody knows where the shaft is, nor how far it went on its way back.
  position_cut_off_ = report->position_cut_off;
  feedback_.angle_at_end = position_cut_off_;
  if (position_cut_off_) loseReference();
  const double drive_rpm = report->erpm / (own_.model->gear_ratio * std::max(own_.pole_pairs, 1));
  feedback_.velocity_rpm = static_cast<float>(toOutput(drive_rpm));
  if (own_.model->signed_current) {
    feedback_.current_a = direction() * static_cast<float>(report->amperes);
    feedback_.torque_nm = feedback_.current_a * torqueNmPerA();
  }
  feedback_.temperature_c = static_cast<float>(report->temperature_c);
  takeError(report->error);
  return FrameVerdict::kAccepted;
}

// ---- Complaints

DriveComplaint CubeMars_Motor::complaint() const noexcept {
  if (error_ != 0) return {cubemarsFault(error_), error_};
  if (stopped_) return {FaultCode::kDriveStopped, 0};
  return scaleComplaint();
}

}  // namespace rc10
