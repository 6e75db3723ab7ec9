#include "drives/lktech/lktech_model.hpp"

#include <array>

#include "motor/model_table.hpp"

namespace rc10 {
namespace {

// CAN protocol V2.35: +-2048 are +-16.5 A for MF, +-33 A for MG and MHF.
constexpr double kMfAmperes = 33.0 / 4096.0;
constexpr double kMgAmperes = 66.0 / 4096.0;

// Torque constants and peak torques of the geared ones and of MHF7015: Alliance-Algorithm/RMCS@0a494d4d
// hardware/device/lk_motor.hpp, after the manufacturer's documents. MF9025 is the winding 16T with 0.32 N·m/A
// (HNUYueLuRM/basic_framework, offisaac/23_Balance_Second; the winding 35T has 0.81) and 4.2 N·m of peak
// torque.
constexpr LktechModel lktechModel(std::string_view name, double gear, double amperes_per_raw,
                                  float rotor_nm_per_a, float peak_nm) {
  return {.name = name,
          .gear_ratio = gear,
          .amperes_per_raw = amperes_per_raw,
          .peak_current_a = peak_nm / (rotor_nm_per_a * static_cast<float>(gear)),
          .rotor_torque_nm_per_a = rotor_nm_per_a};
}

constexpr std::array kLktechModels{
    // Any other direct drive: the current command itself is the limit.
    LktechModel{.name = "LK-MF", .amperes_per_raw = kMfAmperes, .peak_current_a = 16.5F},
    LktechModel{.name = "LK-MHF", .amperes_per_raw = kMgAmperes, .peak_current_a = 33.0F},
    lktechModel("LK-MF9025", 1.0, kMfAmperes, 0.32F, 4.2F),
    lktechModel("LK-MHF7015", 1.0, kMgAmperes, 0.51F, 2.42F),
    lktechModel("LK-MG4005E-i10", 10.0, kMgAmperes, 0.06F, 2.5F),
    lktechModel("LK-MG4010E-i10", 10.0, kMgAmperes, 0.07F, 4.5F),
    lktechModel("LK-MG5010E-i10", 10.0, kMgAmperes, 0.1F, 7.0F),
    lktechModel("LK-MG5010E-i36", 36.0, kMgAmperes, 0.3F, 25.0F),
    lktechModel("LK-MG6012E-i8", 8.0, kMgAmperes, 1.09F / 8.0F, 16.0F),
};

constexpr auto kLktechNames = modelNames(kLktechModels);

// Bits 0 and 3: protocol V2.35. The others: open drivers for MF9025, which agree; V2.35 calls them unused.
constexpr std::array<DriveFault, 8> kLktechFaults{{
    {0x20, FaultCode::kDriveHardware, "short circuit"},
    {0x10, FaultCode::kDriveOverCurrent, "over-current"},
    {0x40, FaultCode::kDriveStalled, "motor stalled"},
    {0x04, FaultCode::kDriveTooHot, "drive too hot"},
    {0x08, FaultCode::kDriveMotorTooHot, "motor too hot"},
    {0x02, FaultCode::kDriveOverVoltage, "supply voltage too high"},
    {0x01, FaultCode::kDriveUnderVoltage, "supply voltage too low"},
    {0x80, FaultCode::kDriveCommunication, "input signal lost"},
}};

}  // namespace

std::span<const std::string_view> lktechModelNames() noexcept { return kLktechNames; }

const LktechModel* findLktechModel(std::string_view name) noexcept { return findModel(kLktechModels, name); }

std::span<const DriveFault> lktechFaults() noexcept { return kLktechFaults; }

}  // namespace rc10
