#include "drives/dji/dji_simulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "drives/dji/dji_family.hpp"
#include "drives/dji/dji_simulated_parameters.hpp"
#include "motor/motor_settings.hpp"

namespace rc10::sim {
namespace {

constexpr std::uint8_t kFrameLength = 8;  // of commands and feedback alike

std::int16_t readInt16(const CanFrame& frame, std::size_t at) noexcept {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(frame.data[at] << 8U | frame.data[at + 1]));
}

void writeInt16(std::array<std::uint8_t, kFrameLength>& data, std::size_t at, double value) noexcept {
  using Limits = std::numeric_limits<std::int16_t>;
  const auto raw = static_cast<std::uint16_t>(
      static_cast<std::int16_t>(std::lround(std::clamp<double>(value, Limits::min(), Limits::max()))));
  data[at] = static_cast<std::uint8_t>(raw >> 8U);
  data[at + 1] = static_cast<std::uint8_t>(raw & 0xFFU);
}

}  // namespace

Result<void> DjiDrive::check(const DriveConfig& config) {
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

DjiDrive::DjiDrive(const DriveConfig& config)
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
      frame.type == FrameType::kData && !frame.fd && frame.length == kFrameLength && frame.id == commandId();
  if (!mine) return;
  const auto& table = model_->command(command_);
  raw_command_ = readInt16(frame, 2 * static_cast<std::size_t>(djiSlot(id_)));
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
  std::array<std::uint8_t, kFrameLength> data{};
  const double sign = encoder_fault_.reversed ? -1.0 : 1.0;
  const double turns = sign * physics_.rotorFraction() + encoder_fault_.slip_turns;
  const int counts_per_turn = model_->encoder.counts_per_turn;
  const auto counts = std::floor((turns - std::floor(turns)) * counts_per_turn);
  writeInt16(data, 0, std::min(counts, counts_per_turn - 1.0));
  writeInt16(data, 2, sign * physics_.measuredRotorRpm());
  writeInt16(data, 4,
             physics_.currentA() / static_cast<double>(model_->feedback_full_scale_a) *
                 model_->feedback_raw_full_scale);
  if (model_->reports_temperature) {
    data[6] = static_cast<std::uint8_t>(std::lround(std::clamp(physics_.temperatureC(), 0.0, 255.0)));
  }
  return makeClassicFrame(feedbackId(), data);
}

void DjiDrive::setLoad(const MotorLoad& load) noexcept {
  load_ = load;
  physics_.setParameters(parametersOf(*model_, gear_ratio_, load));
  physics_.stall(load.stalled);
}

std::unique_ptr<Drive> makeDjiDrive(const MotorSettings& settings, const MotorLoad& load) {
  const DjiMotorConfig motor = djiConfig(settings);
  return std::make_unique<DjiDrive>(DriveConfig{.name = motor.name,
                                                .model = motor.model,
                                                .id = motor.id,
                                                .command = motor.command,
                                                .gear_ratio = motor.gear_ratio,
                                                .load = load});
}

std::function<Result<std::unique_ptr<Drive>>()> djiDrive(DriveConfig config) {
  return [config = std::move(config)]() -> Result<std::unique_ptr<Drive>> {
    if (auto ok = DjiDrive::check(config); !ok) return tl::unexpected(ok.error());
    return std::make_unique<DjiDrive>(config);
  };
}

}  // namespace rc10::sim
