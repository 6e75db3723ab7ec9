#include "drives/myactuator/myactuator_model.hpp"

#include <algorithm>

#include "motor/model_table.hpp"

namespace rc10 {
namespace {

// Gear, rated torque, current and speed: the manufacturer's X-series pages of 2024, as collected in
// 2b-t/myactuator_rmd include/myactuator_rmd/actuator_constants.hpp. X6-60: its data sheet (rated 9.5 A, peak
// 29.1 A). The torque constant is rated torque over rated current, so losses of the gear are in it. The last
// number of a name is the peak torque in N·m; the peak current of the others follows from it.
constexpr MyactuatorModel myactuatorModel(std::string_view name, double gear, float rated_nm, float rated_a,
                                          float rated_rpm, float peak_nm, float nominal_v = 48.0F) {
  return {.name = name,
          .gear_ratio = gear,
          .peak_current_a = peak_nm / (rated_nm / rated_a),
          .torque_nm_per_a = rated_nm / rated_a,
          .rated_rpm = rated_rpm,
          .nominal_v = nominal_v};
}

// Any other drive that speaks protocol V3 or V4: its torque constant comes from the configuration, and the
// current command itself is the only limit (a 16-bit number of 0.01 A).
constexpr MyactuatorModel kOther{.name = "RMD-X", .gear_ratio = 1.0, .peak_current_a = 327.67F};

constexpr std::array kMyactuatorModels{
    kOther,
    myactuatorModel("RMD-X4-3", 6.0, 1.5F, 2.0F, 200.0F, 3.0F, 24.0F),
    myactuatorModel("RMD-X4-24", 36.0, 9.0F, 3.5F, 100.0F, 24.0F, 24.0F),
    myactuatorModel("RMD-X6-7", 6.0, 3.5F, 4.0F, 400.0F, 7.0F),
    myactuatorModel("RMD-X6-8", 8.0, 4.5F, 3.6F, 310.0F, 8.0F),
    myactuatorModel("RMD-X6-40", 36.0, 18.0F, 5.2F, 90.0F, 40.0F),
    myactuatorModel("RMD-X6-60", 19.612, 20.0F, 9.5F, 153.0F, 60.0F),
    myactuatorModel("RMD-X8-20", 6.0, 10.0F, 5.2F, 190.0F, 20.0F),
    myactuatorModel("RMD-X8-25", 9.0, 10.0F, 3.2F, 110.0F, 25.0F),
    myactuatorModel("RMD-X8-60", 36.0, 30.0F, 4.0F, 40.0F, 60.0F),
    myactuatorModel("RMD-X8-90", 18.0, 25.0F, 10.0F, 130.0F, 90.0F),
    myactuatorModel("RMD-X10-40", 7.0, 15.0F, 6.5F, 165.0F, 40.0F),
    myactuatorModel("RMD-X10-100", 35.0, 50.0F, 6.7F, 50.0F, 100.0F),
    myactuatorModel("RMD-X12-150", 12.0, 50.0F, 15.0F, 100.0F, 150.0F),
    myactuatorModel("RMD-X15-400", 11.4, 130.0F, 23.0F, 80.0F, 400.0F),
};

constexpr auto kMyactuatorNames = modelNames(kMyactuatorModels);

// Motion Protocol V4.2 (2024-05), 2.14 for the bits and 8.2 for the levels. 2b-t/myactuator_rmd agrees on the
// bits; 0x0200, 0x0400 and 0x0800 occur without a published meaning.
constexpr std::array<DriveFault, 9> kMyactuatorFaults{{
    {0x0010, FaultCode::kDriveOverCurrent, "phase over-current: short circuit, lost phase, or damage", true},
    {0x0002, FaultCode::kDriveStalled, "motor stalled", true},
    {0x0080, FaultCode::kDriveSetting, "a setting could not be written: settings may be lost", true},
    {0x2000, FaultCode::kDriveCalibration, "encoder calibration is far off"},
    {0x1000, FaultCode::kDriveMotorTooHot, "motor too hot"},
    {0x0008, FaultCode::kDriveOverVoltage, "supply voltage too high"},
    {0x0004, FaultCode::kDriveUnderVoltage, "supply voltage too low"},
    {0x0040, FaultCode::kDriveOverload, "input power too high"},
    {0x0100, FaultCode::kDriveLimit, "turned faster than its own limit"},
}};

}  // namespace

std::span<const std::string_view> myactuatorModelNames() noexcept { return kMyactuatorNames; }

const MyactuatorModel* findMyactuatorModel(std::string_view name) noexcept {
  return findModel(kMyactuatorModels, name);
}

std::span<const DriveFault> myactuatorFaults() noexcept { return kMyactuatorFaults; }

bool myactuatorNeedsReset(std::uint16_t errors) noexcept {
  return std::any_of(kMyactuatorFaults.begin(), kMyactuatorFaults.end(), [errors](const DriveFault& fault) {
    return fault.needs_restart && (errors & fault.native) != 0;
  });
}

}  // namespace rc10
