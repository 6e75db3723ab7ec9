#include "drives/myactuator/myactuator_setup.hpp"

#include <cmath>

#include "bus/byte_order.hpp"

namespace rc10 {
namespace {

// Motion Protocol V4.2: 0x20 and its functions, 0x42, 0x43, 0xB3.
constexpr std::uint8_t kSaveTurns = 4;
constexpr std::uint8_t kSetId = 5;
/// Byte 1 of a frame that needs none.
constexpr std::uint8_t kNoIndex = 0;

struct SettingRequest {
  myactuator::Code write;
  std::uint8_t index = kNoIndex;
};

constexpr double kLeastDegS2 = 100;
constexpr double kMostDegS2 = 60'000;
constexpr std::array kMyactuatorSettings{
    DriveSetting{.name = "timeout_ms", .min = 0, .max = 10'000, .integer = true},
    DriveSetting{.name = "save_turns", .min = 0, .max = 1, .integer = true},
    DriveSetting{
        .name = "position_acceleration_deg_s2", .min = kLeastDegS2, .max = kMostDegS2, .integer = true},
    DriveSetting{
        .name = "position_deceleration_deg_s2", .min = kLeastDegS2, .max = kMostDegS2, .integer = true},
    DriveSetting{
        .name = "velocity_acceleration_deg_s2", .min = kLeastDegS2, .max = kMostDegS2, .integer = true},
    DriveSetting{
        .name = "velocity_deceleration_deg_s2", .min = kLeastDegS2, .max = kMostDegS2, .integer = true},
    DriveSetting{.name = "id", .min = 1, .max = myactuator::kMaxId, .integer = true, .identity = true},
};
// The id with function 5 of 0x20, which has an addressee: 0x79 on 0x300 would give it to every drive there.
constexpr std::array kSettingRequests{SettingRequest{myactuator::Code::kSilenceLimit},
                                      SettingRequest{myactuator::Code::kFunction, kSaveTurns},
                                      SettingRequest{myactuator::Code::kSetAcceleration, 0},
                                      SettingRequest{myactuator::Code::kSetAcceleration, 1},
                                      SettingRequest{myactuator::Code::kSetAcceleration, 2},
                                      SettingRequest{myactuator::Code::kSetAcceleration, 3},
                                      SettingRequest{myactuator::Code::kFunction, kSetId}};
static_assert(kSettingRequests.size() == kMyactuatorSettings.size());

constexpr DriveSetup kMyactuatorSetup{
    .settings = kMyactuatorSettings, .stores_at_once = true, .tool = "MyActuator's setup software"};

}  // namespace

const DriveSetup& myactuatorSetup() noexcept { return kMyactuatorSetup; }

CanFrame MyactuatorSetupCodec::write(const DriveValue& value) const noexcept {
  const auto& row = kSettingRequests[value.setting];
  CanFrame frame = myactuator::request(id_, row.write);
  frame.data[1] = row.index;
  writeLittleEndian(frame.data, 4, static_cast<std::uint32_t>(std::lround(value.value)));
  return frame;
}

std::optional<CanFrame> MyactuatorSetupCodec::read(std::size_t setting) const noexcept {
  const auto& row = kSettingRequests[setting];
  if (row.write != myactuator::Code::kSetAcceleration) return std::nullopt;
  CanFrame frame = myactuator::request(id_, myactuator::Code::kReadAcceleration);
  frame.data[1] = row.index;
  return frame;
}

std::optional<double> MyactuatorSetupCodec::reading(std::size_t setting,
                                                    const CanFrame& frame) const noexcept {
  const auto& row = kSettingRequests[setting];
  if (frame.length != myactuator::kLength) return std::nullopt;
  const auto bytes = frame.payload();
  const myactuator::Code told =
      row.write == myactuator::Code::kSetAcceleration ? myactuator::Code::kReadAcceleration : row.write;
  if (myactuator::codeOf(bytes) != told || bytes[1] != row.index) return std::nullopt;
  return static_cast<double>(readLittleEndian<std::uint32_t>(bytes, 4));
}

std::optional<std::size_t> MyactuatorSetupCodec::idSetting() const noexcept {
  return kMyactuatorSettings.size() - 1;
}

}  // namespace rc10
