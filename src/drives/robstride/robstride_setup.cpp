#include "drives/robstride/robstride_setup.hpp"

#include <bit>
#include <cmath>

#include "bus/byte_order.hpp"

namespace rc10 {
namespace {

namespace parameter = robstride::parameter;

/// Form of a setting in its parameter; manuals, "Readable and writable single parameters".
struct SettingParameter {
  std::uint16_t index = 0;  ///< 0: the id, which has a frame of its own.
  bool whole = false;       ///< An unsigned integer; else a float.
  double per_unit = 1.0;
  double at_zero = 0.0;  ///< Value of the parameter for a setting of 0.
};

constexpr std::array kRobstrideSettings{
    DriveSetting{.name = "id", .min = 1, .max = 127, .integer = true, .identity = true},
    DriveSetting{.name = "timeout_ms", .min = 0, .max = 5000, .integer = true},
    DriveSetting{.name = "report_interval_ms", .min = 10, .max = 1000, .integer = true},
    DriveSetting{.name = "zero_range", .min = 0, .max = 1, .integer = true},
    DriveSetting{.name = "torque_limit_nm", .min = 0, .max = 120},
    DriveSetting{.name = "current_limit_a", .min = 0, .max = 90},
    DriveSetting{.name = "velocity_limit_rad_s", .min = 0, .max = 50},
    DriveSetting{.name = "position_kp", .min = 0, .max = 1000},
    DriveSetting{.name = "velocity_kp", .min = 0, .max = 1000},
    DriveSetting{.name = "velocity_ki", .min = 0, .max = 1000},
};

constexpr std::array kSettingParameters{
    SettingParameter{},
    SettingParameter{0x7028, true, robstride::kTimeoutPerMs},
    SettingParameter{0x7026, true, 0.2, -1.0},  // 1: 10 ms; each more: 5 ms
    SettingParameter{0x7029, true},
    SettingParameter{parameter::kTorqueLimit},
    SettingParameter{parameter::kCurrentLimit},
    SettingParameter{parameter::kVelocityLimit},
    SettingParameter{0x701E},
    SettingParameter{0x701F},
    SettingParameter{0x7020},
};
static_assert(kSettingParameters.size() == kRobstrideSettings.size());

constexpr DriveSetup kRobstrideSetup{
    .settings = kRobstrideSettings, .saves_in_silence = true, .tool = "RobStride's Motor Studio"};
constexpr DriveSetup kCyberGearSetup{.settings = std::span(kRobstrideSettings).first(1),
                                     .stores_at_once = true,
                                     .tool = "Xiaomi's CyberGear tool"};

std::uint32_t rawOf(const SettingParameter& row, double value) noexcept {
  const double raw = value * row.per_unit + row.at_zero;
  return row.whole ? static_cast<std::uint32_t>(std::lround(raw))
                   : std::bit_cast<std::uint32_t>(static_cast<float>(raw));
}

}  // namespace

const DriveSetup& robstrideSetup(bool cyber_gear) noexcept {
  return cyber_gear ? kCyberGearSetup : kRobstrideSetup;
}

CanFrame RobstrideSetupCodec::write(const DriveValue& value) const noexcept {
  const auto& row = kSettingParameters[value.setting];
  if (row.index != 0) return codec_.write(row.index, rawOf(row, value.value));
  const auto new_id = static_cast<std::uint32_t>(std::lround(value.value)) & 0xFFU;
  const auto data = new_id << 8U | static_cast<std::uint32_t>(codec_.host_id);
  return makeClassicFrame(robstride::canId(robstride::Type::kSetId, data, codec_.drive_id),
                          std::array<std::uint8_t, 8>{});
}

std::optional<CanFrame> RobstrideSetupCodec::read(std::size_t setting) const noexcept {
  const auto& row = kSettingParameters[setting];
  if (row.index == 0) return std::nullopt;  // nothing tells it but the silence under the old one
  return codec_.read(row.index);
}

std::optional<double> RobstrideSetupCodec::reading(std::size_t setting,
                                                   const CanFrame& frame) const noexcept {
  const auto& row = kSettingParameters[setting];
  const auto type = static_cast<robstride::Type>(frame.id.value >> 24U & 0x1FU);
  const bool accepted = (frame.id.value >> 16U & 0xFFU) == 0;
  if (row.index == 0 || type != robstride::Type::kReadParameter || !accepted || frame.length != 8) {
    return std::nullopt;
  }
  const auto bytes = frame.payload();
  if (readLittleEndian<std::uint16_t>(bytes, 0) != row.index) return std::nullopt;
  const auto bits = readLittleEndian<std::uint32_t>(bytes, 4);
  const double raw = row.whole ? static_cast<double>(bits) : static_cast<double>(std::bit_cast<float>(bits));
  return (raw - row.at_zero) / row.per_unit;
}

std::optional<CanFrame> RobstrideSetupCodec::save(std::optional<int> new_id) const noexcept {
  if (codec_.model->cyber_gear) return std::nullopt;
  return makeClassicFrame(robstride::canId(robstride::Type::kSave, static_cast<std::uint32_t>(codec_.host_id),
                                           new_id.value_or(codec_.drive_id)),
                          std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 6, 7, 8});
}

bool RobstrideSetupCodec::saysSaved(const CanFrame& frame) const noexcept {
  return static_cast<robstride::Type>(frame.id.value >> 24U & 0x1FU) == robstride::Type::kFeedback;
}

}  // namespace rc10
