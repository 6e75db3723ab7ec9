#include "drives/dji/dji_simulated.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "drives/dji/dji_frames.hpp"
#include "drives/dji/dji_simulated_parameters.hpp"
#include "motor/motor_settings.hpp"

namespace rc10::sim {
namespace {

template <typename Int>
Int nearest(double value) noexcept {
  using Limits = std::numeric_limits<Int>;
  return static_cast<Int>(std::lround(std::clamp<double>(value, Limits::min(), Limits::max())));
}

}  // namespace

Result<void> DjiDrive::check(const DjiDriveConfig& config) {
  const auto refuse = [&](const std::string& why) {
    return fail("simulated motor '" + config.name + "': " + why);
  };
  if (config.model == nullptr) return refuse("it has no model");
  const std::string model{config.model->name};
  if (config.id < 1 || config.id > config.model->max_id) {
    return refuse("id " + std::to_string(config.id) + " does not exist on a " + model + ": use 1 to " +
                  std::to_string(config.model->max_id));
  }
  if (!config.model->command(config.command).exists()) {
    return refuse("a " + model + " has no voltage command: use current");
  }
  const bool is_gear = std::isfinite(config.gear_ratio) && config.gear_ratio >= 0.0;
  if (!is_gear) return refuse("gear_ratio must be above 0, or 0 for the model's own");
  return checkLoad(config.name, config.load);
}

DjiDrive::DjiDrive(const DjiDriveConfig& config)
    : name_(config.name),
      model_(config.model),
      id_(config.id),
      command_(config.command),
      gear_ratio_(gearRatioOf(config, *config.model)),
      sends_{FrameFilter{.id = feedbackId()}},
      load_(config.load),
      physics_(parametersOf(*config.model, gear_ratio_, config.load),
               static_cast<double>(config.load.initial_angle_deg)) {
  physics_.stall(load_.stalled);
  winding_.kind =
      command_ == DjiCommand::kVoltage ? WindingCommand::Kind::kVoltage : WindingCommand::Kind::kCurrent;
}

CanId DjiDrive::commandId() const noexcept { return djiCommandId(*model_, command_, id_); }

CanId DjiDrive::feedbackId() const noexcept { return djiFeedbackId(*model_, id_); }

void DjiDrive::receive(const CanFrame& frame) noexcept {
  const bool mine =
      frame.type == FrameType::kData && !frame.fd && frame.length == dji::kLength && frame.id == commandId();
  if (!mine) return;
  const auto& table = model_->command(command_);
  raw_command_ = dji::decodeCommand(frame.payload(), static_cast<std::size_t>(djiSlot(id_)));
  // Beyond full scale the current or supply limit cuts off.
  winding_.value = static_cast<double>(table.full_scale) * raw_command_ / table.raw_full_scale;
}

void DjiDrive::step(Duration dt) noexcept { physics_.step(winding_, dt); }

void DjiDrive::setEncoderFault(const EncoderFault& fault) noexcept {
  if (fault.frozen && !encoder_fault_.frozen) frozen_ = feedbackFrame();
  encoder_fault_ = fault;
}

std::size_t DjiDrive::feedback(std::span<CanFrame> out) noexcept {
  out[0] = feedbackFrame();
  return 1;
}

CanFrame DjiDrive::feedbackFrame() const noexcept {
  if (encoder_fault_.frozen) return frozen_;
  const double sign = encoder_fault_.reversed ? -1.0 : 1.0;
  const double turns = sign * physics_.rotorFraction() + encoder_fault_.slip_turns;
  const auto counts = std::floor((turns - std::floor(turns)) * dji::kCountsPerTurn);
  const double current_share = physics_.currentA() / static_cast<double>(model_->feedback_full_scale_a);
  return dji::feedbackFrame(
      feedbackId(),
      {.encoder = nearest<std::uint16_t>(std::min(counts, dji::kCountsPerTurn - 1.0)),
       .rotor_rpm = nearest<std::int16_t>(sign * physics_.measuredRotorRpm()),
       .current_raw = nearest<std::int16_t>(current_share * model_->feedback_raw_full_scale),
       .temperature_c =
           model_->reports_temperature ? nearest<std::uint8_t>(physics_.temperatureC()) : std::uint8_t{0}});
}

void DjiDrive::setLoad(const MotorLoad& load) noexcept {
  load_ = load;
  physics_.setParameters(parametersOf(*model_, gear_ratio_, load));
  physics_.stall(load.stalled);
}

std::unique_ptr<Drive> makeDjiDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<DjiDrive>(DjiDriveConfig{.name = settings.name,
                                                   .model = findDjiModel(settings.model),
                                                   .id = settings.id,
                                                   .command = djiSettings(settings.own).command,
                                                   .gear_ratio = settings.gear_ratio,
                                                   .load = load});
}

std::function<Result<std::unique_ptr<Drive>>()> djiDrive(DjiDriveConfig config) {
  return [config = std::move(config)]() -> Result<std::unique_ptr<Drive>> {
    if (auto ok = DjiDrive::check(config); !ok) return tl::unexpected(ok.error());
    return std::make_unique<DjiDrive>(config);
  };
}

}  // namespace rc10::sim
