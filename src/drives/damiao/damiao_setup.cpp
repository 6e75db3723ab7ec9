#include "drives/damiao/damiao_setup.hpp"

#include <cmath>

namespace rc10 {
namespace {

using damiao::Register;

/// Form of a setting in its register. Numbers and ranges: DM-J manuals of 2026, "Register List".
struct SettingRegister {
  Register address;
  bool whole = false;     ///< An unsigned integer; else a float.
  double per_unit = 1.0;  ///< Units of the register for one of the setting.
};

constexpr std::array kDamiaoSettings{
    DriveSetting{.name = "timeout_ms", .min = 0, .max = 10'000},
    DriveSetting{.name = "control_mode", .min = 1, .max = 4, .integer = true},
    DriveSetting{.name = "under_voltage_v", .min = 10, .max = 100},
    DriveSetting{.name = "over_voltage_v", .min = 12, .max = 100},
    DriveSetting{.name = "over_temperature_c", .min = 80, .max = 199},
    DriveSetting{.name = "over_current_pu", .min = 0.01, .max = 0.99},
    DriveSetting{.name = "acceleration_rad_s2", .min = 0.1, .max = 10'000},
    DriveSetting{.name = "deceleration_rad_s2", .min = -10'000, .max = -0.1},
    DriveSetting{.name = "max_speed_rad_s", .min = 0.1, .max = 10'000},
    DriveSetting{.name = "p_max_rad", .min = 0.1, .max = 1000},
    DriveSetting{.name = "v_max_rad_s", .min = 0.1, .max = 1000},
    DriveSetting{.name = "t_max_nm", .min = 0.1, .max = 1000},
    DriveSetting{.name = "master_id", .min = 0, .max = 2046, .integer = true, .identity = true},
    DriveSetting{.name = "id", .min = 1, .max = damiao::kMaxId, .integer = true, .identity = true},
};

constexpr std::array kSettingRegisters{
    SettingRegister{Register::kTimeout, true, 1.0 / damiao::kTimeoutStepMs},
    SettingRegister{Register::kControlMode, true},
    SettingRegister{Register::kUnderVoltage},
    SettingRegister{Register::kOverVoltage},
    SettingRegister{Register::kOverTemperature},
    SettingRegister{Register::kOverCurrent},
    SettingRegister{Register::kAcceleration},
    SettingRegister{Register::kDeceleration},
    SettingRegister{Register::kMaxSpeed},
    SettingRegister{Register::kPMax},
    SettingRegister{Register::kVMax},
    SettingRegister{Register::kTMax},
    SettingRegister{Register::kMasterId, true},
    SettingRegister{Register::kId, true},
};
static_assert(kSettingRegisters.size() == kDamiaoSettings.size());

constexpr DriveSetup kDamiaoSetup{.settings = kDamiaoSettings, .tool = "the DM Debug Tool"};

std::optional<damiao::RegisterReply> replyIn(const CanFrame& frame, int id) noexcept {
  if (frame.type != FrameType::kData || frame.length != 8) return std::nullopt;
  return damiao::readReply(std::span(frame.data).first<8>(), id);
}

}  // namespace

const DriveSetup& damiaoSetup() noexcept { return kDamiaoSetup; }

CanFrame DamiaoSetupCodec::toRegisters(const damiao::Payload& payload) const noexcept {
  constexpr CanId kTo{damiao::kRegisterId, false};
  return can_fd_ ? makeFdFrame(kTo, payload, true) : makeClassicFrame(kTo, payload);
}

CanFrame DamiaoSetupCodec::write(const DriveValue& value) const noexcept {
  const auto& row = kSettingRegisters[value.setting];
  const double raw = value.value * row.per_unit;
  const auto bits =
      row.whole ? static_cast<std::uint32_t>(std::lround(raw)) : damiao::bitsOf(static_cast<float>(raw));
  return toRegisters(damiao::writeRegister(id_, row.address, bits));
}

std::optional<CanFrame> DamiaoSetupCodec::read(std::size_t setting) const noexcept {
  return toRegisters(damiao::readRegister(id_, kSettingRegisters[setting].address));
}

std::optional<double> DamiaoSetupCodec::reading(std::size_t setting, const CanFrame& frame) const noexcept {
  const auto reply = replyIn(frame, id_);
  const auto& row = kSettingRegisters[setting];
  if (!reply || reply->written || reply->address != row.address) return std::nullopt;
  const double raw =
      row.whole ? static_cast<double>(reply->value) : static_cast<double>(damiao::floatOf(reply->value));
  return raw / row.per_unit;
}

std::optional<CanFrame> DamiaoSetupCodec::save(std::optional<int> new_id) const noexcept {
  return toRegisters(damiao::saveRegisters(new_id.value_or(id_)));
}

bool DamiaoSetupCodec::saysSaved(const CanFrame& frame) const noexcept {
  const auto reply = replyIn(frame, id_);
  return reply && reply->written && reply->address == Register{};
}

std::optional<std::size_t> DamiaoSetupCodec::idSetting() const noexcept { return kDamiaoSettings.size() - 1; }

}  // namespace rc10
