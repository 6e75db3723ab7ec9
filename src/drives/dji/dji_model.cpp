#include "drives/dji/dji_model.hpp"

#include <chrono>

// Figures without a source of their own are from the vendor's manuals: C620 V1.01, C610, GM6020 v1.2,
// M3508 V1.0, M2006-P36.
namespace rc10 {
namespace {

using std::chrono::microseconds;

constexpr Duration kFeedbackPeriod = std::chrono::milliseconds{1};  // 1 kHz, free-running, all three drives

// A full 1 Mbit/s bus carries seven frames of 135 us in a millisecond, so a frame waits for at most
// six others. The kernel's stamp adds little to that.
constexpr Duration kStampError = microseconds{800};
// The drives do not say how their speed is filtered. Assumed: no more than 2 ms behind the position.
constexpr float kSpeedDelaySeconds = 0.002F;

/// `max_acceleration`: see each model. The reported speed is off by its delay and by half a count.
constexpr Encoder::Config encoder(float max_velocity_rpm, float max_acceleration_rpm_per_s) {
  return {.counts_per_turn = 8192,
          .max_velocity_rpm = max_velocity_rpm,
          .max_acceleration_rpm_per_s = max_acceleration_rpm_per_s,
          .velocity_error_rpm = max_acceleration_rpm_per_s * kSpeedDelaySeconds + 0.5F,
          .stamp_error = kStampError,
          .sample_period = kFeedbackPeriod};
}

// Rotor side. Speed: 482 rpm * 19.2 at 24 V, with 10 % for a full 6S battery (25.2 V) and a load that
// drives. Acceleration: 20 A * 0.0156 Nm/A on a bare rotor of about 1.1e-5 kg m^2 (estimated, not
// published) is 270,000 rpm/s.
constexpr Encoder::Config kM3508Encoder = encoder(10'200.0F, 300'000.0F);
constexpr int kM3508LostFrames = 10;
// Rotor side: 500 rpm * 36 and 10 %; 10 A * 0.005 Nm/A on about 1.3e-6 kg m^2 (estimated) is
// 370,000 rpm/s.
constexpr Encoder::Config kM2006Encoder = encoder(19'800.0F, 400'000.0F);
constexpr int kM2006LostFrames = 5;
// Output side: 320 rpm and 10 %; 3 A * 0.741 Nm/A on a bare rotor of about 2.5e-4 kg m^2 (estimated)
// is 85,000 rpm/s. In volts it may be more, and does not matter: from full speed one way to full speed
// the other way is 2 * 352 rpm * 30 ms = 0.35 turns.
constexpr Encoder::Config kGM6020Encoder = encoder(352.0F, 100'000.0F);
constexpr int kGM6020LostFrames = 28;

static_assert(Encoder::exactOver(kM3508Encoder, kM3508LostFrames, kFeedbackPeriod));
static_assert(Encoder::exactOver(kM2006Encoder, kM2006LostFrames, kFeedbackPeriod));
static_assert(Encoder::exactOver(kGM6020Encoder, kGM6020LostFrames, kFeedbackPeriod));

// Tuned on tests/support/simple_plant.hpp, bounds in dji_closed_loop_test.cpp: damped from half to
// three times the inertia there (M3508 0.004 kg m^2, about the bare rotor; M2006 0.003; GM6020 0.005),
// stable at ten times, with 2.5 ms of delay. Crossover of the velocity loops: 80-140 rad/s. The angle
// loops stay below the speed from which a wheel of three times that inertia can still be stopped.
constexpr CascadeConfig kM3508Loops{.velocity = PID_Position::Config{.kp = 0.2F, .ki = 1.6F},
                                    .angle = {.kp = 4.0F, .output_limit = 200.0F},
                                    .velocity_limit_rpm = 480.0F};
constexpr CascadeConfig kM2006Loops{.velocity = PID_Position::Config{.kp = 0.2F, .ki = 1.6F},
                                    .angle = {.kp = 4.0F, .output_limit = 150.0F},
                                    .velocity_limit_rpm = 500.0F};
constexpr CascadeConfig kGM6020CurrentLoops{.velocity = PID_Position::Config{.kp = 0.06F, .ki = 0.5F},
                                            .angle = {.kp = 3.0F, .output_limit = 120.0F},
                                            .velocity_limit_rpm = 320.0F};
constexpr CascadeConfig kGM6020VoltageLoops{.velocity = PID_Position::Config{.kp = 0.1F, .ki = 3.0F},
                                            .angle = {.kp = 3.0F, .output_limit = 120.0F},
                                            .velocity_limit_rpm = 320.0F};

}  // namespace

constexpr DjiModel kM3508{
    .name = "M3508",
    .gear_ratio = 3591.0 / 187.0,
    .feedback_id_base = 0x200,
    .max_id = 8,
    .rotor_torque_nm_per_a = 0.3F * 187.0F / 3591.0F,  // 0.3 Nm/A at the output
    .feedback_full_scale_a = 20.0F,                    // not stated; all code read uses the command's scale
    .feedback_raw_full_scale = 16384,
    .reports_temperature = true,
    .absolute_output = false,
    .no_load_rpm = 482.0F,
    .encoder = kM3508Encoder,
    .countable_lost_frames = kM3508LostFrames,
    .current = {.command_ids = {0x200, 0x1FF},
                .full_scale = 20.0F,
                .raw_full_scale = 16384,
                .default_loops = kM3508Loops},
    .voltage = {}};

constexpr DjiModel kM2006{.name = "M2006",
                          .gear_ratio = 36.0,
                          .feedback_id_base = 0x200,
                          .max_id = 8,
                          .rotor_torque_nm_per_a = 0.18F / 36.0F,  // 0.18 Nm/A at the output
                          .feedback_full_scale_a = 10.0F,  // C610 manual; RMCS differs with 16384 = 10 A
                          .feedback_raw_full_scale = 10000,
                          .reports_temperature = false,  // the byte is null
                          .absolute_output = false,
                          .no_load_rpm = 500.0F,
                          .encoder = kM2006Encoder,
                          .countable_lost_frames = kM2006LostFrames,
                          .current = {.command_ids = {0x200, 0x1FF},
                                      .full_scale = 10.0F,
                                      .raw_full_scale = 10000,
                                      .default_loops = kM2006Loops},
                          .voltage = {}};

constexpr DjiModel kGM6020{
    .name = "GM6020",
    .gear_ratio = 1.0,
    .feedback_id_base = 0x204,
    .max_id = 7,
    .rotor_torque_nm_per_a = 0.741F,
    .feedback_full_scale_a = 3.0F,  // not stated; the current command's scale
    .feedback_raw_full_scale = 16384,
    .reports_temperature = true,
    .absolute_output = true,
    .no_load_rpm = 320.0F,
    .encoder = kGM6020Encoder,
    .countable_lost_frames = kGM6020LostFrames,
    // Newer firmware only, switched on in RoboMaster Assistant ("enable current ring").
    .current = {.command_ids = {0x1FE, 0x2FE},
                .full_scale = 3.0F,
                .raw_full_scale = 16384,
                .default_loops = kGM6020CurrentLoops},
    // Manual v1.2 allows 30000; later community code measured 25000 = 24 V. The smaller one is safe.
    .voltage = {.command_ids = {0x1FF, 0x2FF},
                .full_scale = 24.0F,
                .raw_full_scale = 25000,
                .default_loops = kGM6020VoltageLoops}};

namespace {

constexpr bool near(double value, double expected, double tolerance) {
  return value > expected - tolerance && value < expected + tolerance;
}
static_assert(near(kM3508.gear_ratio, 19.2032, 1e-4));
static_assert(near(static_cast<double>(kM3508.rotor_torque_nm_per_a), 0.015622, 1e-6));
static_assert(near(static_cast<double>(kM2006.rotor_torque_nm_per_a), 0.005, 1e-9));
static_assert(kM3508.current.exists() && !kM3508.voltage.exists());
static_assert(kGM6020.current.exists() && kGM6020.voltage.exists());

}  // namespace

DjiSettings djiSettings(const OwnValues& own) {
  return {.command = own.text("command") == "voltage" ? DjiCommand::kVoltage : DjiCommand::kCurrent};
}

const DjiModel* findDjiModel(std::string_view name) noexcept {
  for (const auto* model : djiModels()) {
    if (model->name == name) return model;
  }
  return nullptr;
}

std::array<const DjiModel*, 3> djiModels() noexcept { return {&kM3508, &kM2006, &kGM6020}; }

CanId djiFeedbackId(const DjiModel& model, int id) noexcept {
  return {model.feedback_id_base + static_cast<std::uint32_t>(id), false};
}

CanId djiCommandId(const DjiModel& model, DjiCommand command, int id) noexcept {
  return {model.command(command).command_ids[id > 4 ? 1 : 0], false};
}

}  // namespace rc10
