// The private protocol of RobStride and CyberGear: type (bits 28-24), data (23-8), addressee (7-0).
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "bus/can_frame.hpp"
#include "drives/robstride/robstride_model.hpp"
#include "faults/wire.hpp"

namespace rc10::test {
namespace {

constexpr int kLateReports = 4;
constexpr double kRoundRad = 8.0 * std::numbers::pi;
constexpr std::uint32_t kWatchdogPerMs = 20;  // 20000: a second
constexpr std::uint16_t kRunMode = 0x7005;
constexpr std::uint16_t kCurrentRef = 0x7006;
constexpr std::uint16_t kVelocityRef = 0x700A;
constexpr std::uint16_t kTorqueLimit = 0x700B;
constexpr std::uint16_t kPositionRef = 0x7016;
constexpr std::uint16_t kVelocityLimit = 0x7017;
constexpr std::uint16_t kCurrentLimit = 0x7018;

class RobstrideWire final : public Wire {
 public:
  explicit RobstrideWire(const MotorConfig& config)
      : Wire(config),
        model_(findRobstrideModel(config.settings.model)),
        host_(static_cast<std::uint32_t>(config.settings.own.integer("host_id"))),
        watchdog_(static_cast<std::uint32_t>(config.settings.own.integer("watchdog_ms")) * kWatchdogPerMs) {
    const double range_rad = config.settings.own.number("position_range_rad");
    range_rad_ = range_rad > 0.0 ? range_rad : model_->position_range_rad;
    speed_field_end_rad_s_ = model_->velocity_range_rad_s;
  }

  std::uint64_t said(const CanFrame& frame) override {
    if (!frame.id.extended || (frame.id.value & 0xFFU) != static_cast<std::uint32_t>(id())) return 0;
    const std::uint32_t type = frame.id.value >> 24U & 0x1FU;
    if (type != 1 && (frame.id.value >> 8U & 0xFFFFU) != host_) return 0;
    if (!plainFrame(frame, 8)) refuse(frame, "a command frame of another form");
    switch (type) {
      case 1: saidOperate(frame); break;
      case 3: saidEnable(frame); break;
      case 4: forget(); break;
      case 17: break;  // a question
      case 18: saidWrite(frame); break;
      default: refuse(frame, "its zero, its id, its flash, or nothing known");
    }
    return kAllBytes;
  }

  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    const std::uint32_t type = frame.id.value >> 24U & 0x1FU;
    const bool to_it = frame.id.extended && (frame.id.value & 0xFFU) == static_cast<std::uint32_t>(id());
    return to_it && plainFrame(frame, 8) && (type == 1 || type == 18);
  }

  bool heard(const CanFrame& frame) override {
    const std::uint32_t type = frame.id.value >> 24U & 0x1FU;
    const std::uint32_t from_to = static_cast<std::uint32_t>(id()) << 8U | host_;
    if (!frame.id.extended || !plainFrame(frame, 8) || (type != 2 && type != 24)) return false;
    if ((frame.id.value & 0xFFFFU) != from_to) return false;
    // Its answers to what came before may still be under way.
    const bool runs = (frame.id.value >> 22U & 3U) == 2U;
    if (++reports_ > kLateReports && !runs) on_ = false;
    position_rad_ = onScale(bigEndian(frame, 0, 2), -range_rad_, range_rad_, 16);
    velocity_rad_s_ =
        onScale(bigEndian(frame, 2, 2), -model_->velocity_range_rad_s, model_->velocity_range_rad_s, 16);
    measured_.velocity_rpm = rpmOfRadPerS(velocity_rad_s_);
    measured_.temperature_c = int16Of(bigEndian(frame, 6, 2)) * 0.1;
    return true;
  }

  [[nodiscard]] Told told() const override {
    Told told{.effort_step = std::fabs(effortOfNm(model_->torque_range_nm)) * 2.0 / 65535.0,
              .velocity_step_rpm = std::fabs(rpmOfRadPerS(model_->velocity_range_rad_s)) * 2.0 / 65535.0};
    if (!on_) return told;
    switch (run_mode_) {
      case 0: return operated(told);
      case 2:
        told.law = Told::Law::kVelocity;
        told.velocity_rpm = rpmOfRadPerS(velocity_ref_rad_s_);
        told.most_effort = current_limit_a_;
        return told;
      case 3:
        told.law = Told::Law::kEffort;
        told.effort = direction() * current_ref_a_;
        return told;
      default:
        told.law = Told::Law::kAngle;
        told.most_effort = current_limit_a_;
        told.most_rpm = std::fabs(rpmOfRadPerS(velocity_limit_rad_s_));
        // A newer firmware's position goes round by two whole turns on each side, its reference does not.
        told.ahead_deg = degOfRad(std::remainder(position_ref_rad_ - seen_rad_, kRoundRad));
        told.ahead_turn_deg = std::fabs(degOfRad(kRoundRad));
        told.ahead_step_deg = std::fabs(degOfRad(1e-3 + 1e-6 * std::fabs(position_ref_rad_)));
        return told;
    }
  }

 private:
  void forget() {
    on_ = false;
    operated_.reset();
  }

  void saidEnable(const CanFrame& frame) {
    if (watchdog_ > 0 && !watchdog_told_) refuse(frame, "enabled without its watchdog");
    if (run_mode_ == 0 && !torque_bounded_) refuse(frame, "enabled without its torque limit");
    on_ = true;
    reports_ = 0;
  }

  void saidOperate(const CanFrame& frame) {
    const double torque = model_->torque_range_nm;
    operated_ =
        MitFields{.position_rad = onScale(bigEndian(frame, 0, 2), -range_rad_, range_rad_, 16),
                  .velocity_rad_s = onScale(bigEndian(frame, 2, 2), -model_->velocity_range_rad_s,
                                            model_->velocity_range_rad_s, 16),
                  .stiffness = onScale(bigEndian(frame, 4, 2), 0.0, model_->stiffness_range_nm_per_rad, 16),
                  .damping = onScale(bigEndian(frame, 6, 2), 0.0, model_->damping_range_nms_per_rad, 16),
                  .torque_nm = onScale(frame.id.value >> 8U & 0xFFFFU, -torque, torque, 16)};
    seen_rad_ = position_rad_;
    seen_rad_s_ = velocity_rad_s_;
  }

  void saidWrite(const CanFrame& frame) {
    const auto value = static_cast<double>(floatOf(littleEndian(frame, 4, 4)));
    switch (const auto index = static_cast<std::uint16_t>(littleEndian(frame, 0, 2))) {
      case kRunMode: run_mode_ = frame.data[4]; break;
      case kCurrentRef: current_ref_a_ = value; break;
      case kVelocityRef: velocity_ref_rad_s_ = value; break;
      case kCurrentLimit: current_limit_a_ = value; break;
      case kPositionRef:
        position_ref_rad_ = value;
        seen_rad_ = position_rad_;
        break;
      case kVelocityLimit: velocity_limit_rad_s_ = value; break;
      case kTorqueLimit: {
        const auto own = static_cast<double>(settings().effort_limit);
        const double most = own > 0.0 ? own : static_cast<double>(traits().effort_full_scale);
        if (!(std::fabs(effortOfNm(value)) <= most * (1.0 + 1e-4)))
          refuse(frame, "a torque limit beyond its limit");
        torque_bounded_ = true;
        break;
      }
      default:
        if (index != model_->watchdog_index) refuse(frame, "a parameter that rc10d has no business with");
        if (littleEndian(frame, 4, 4) != watchdog_) refuse(frame, "another watchdog than its own");
        watchdog_told_ = true;
    }
  }

  [[nodiscard]] Told operated(Told told) const {
    told.law = Told::Law::kEffort;
    if (!operated_) return told;
    constexpr double kCodes = 65535.0;
    told = springOf(*operated_,
                    {.position_rad = 2.0 * range_rad_ / kCodes,
                     .velocity_rad_s = 2.0 * model_->velocity_range_rad_s / kCodes,
                     .stiffness = model_->stiffness_range_nm_per_rad / kCodes,
                     .damping = model_->damping_range_nms_per_rad / kCodes,
                     .torque_nm = 2.0 * model_->torque_range_nm / kCodes},
                    seen_rad_, seen_rad_s_);
    // A newer firmware's position goes on at the other end of the scale: no sum without a guess.
    const double end_rad = 0.9 * range_rad_;
    const bool near = std::fabs(seen_rad_) < end_rad && std::fabs(operated_->position_rad) < end_rad;
    if (told.stiff && !near) told.sum = told.ahead_deg = kUnsaid;
    return told;
  }

  const RobstrideModel* model_;
  std::uint32_t host_;
  std::uint32_t watchdog_;
  bool watchdog_told_ = false;
  bool torque_bounded_ = false;
  double range_rad_ = 0.0;
  bool on_ = false;
  int reports_ = 0;  // since it was enabled
  int run_mode_ = 0;
  std::optional<MitFields> operated_;
  double current_ref_a_ = 0.0;
  double velocity_ref_rad_s_ = 0.0;
  double position_ref_rad_ = 0.0;
  double velocity_limit_rad_s_ = kUnsaid;
  double current_limit_a_ = 0.0;
  double position_rad_ = 0.0;
  double velocity_rad_s_ = 0.0;
  double seen_rad_ = 0.0;  // as of the last command
  double seen_rad_s_ = 0.0;
};

}  // namespace

std::unique_ptr<Wire> makeRobstrideWire(const MotorConfig& config) {
  return std::make_unique<RobstrideWire>(config);
}

}  // namespace rc10::test
