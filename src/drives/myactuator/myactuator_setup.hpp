#pragma once

#include "drives/myactuator/myactuator_frames.hpp"
#include "motor/drive_setup.hpp"

namespace rc10 {

/// Settings that can be written to an RMD-X drive. It stores each at once.
[[nodiscard]] const DriveSetup& myactuatorSetup() noexcept;

/// The settings of one drive. Each is written with frames of its own kind; accelerations alone can be read.
class MyactuatorSetupCodec final : public DriveCodec {
 public:
  explicit MyactuatorSetupCodec(int id) noexcept : id_(id) {}

  [[nodiscard]] const DriveSetup& setup() const noexcept override { return myactuatorSetup(); }
  [[nodiscard]] CanFrame write(const DriveValue& value) const noexcept override;
  [[nodiscard]] std::optional<CanFrame> read(std::size_t setting) const noexcept override;
  [[nodiscard]] std::optional<double> reading(std::size_t setting,
                                              const CanFrame& frame) const noexcept override;
  [[nodiscard]] std::optional<CanFrame> save(std::optional<int> /*new_id*/) const noexcept override {
    return std::nullopt;
  }
  [[nodiscard]] bool saysSaved(const CanFrame& /*frame*/) const noexcept override { return false; }
  [[nodiscard]] std::optional<std::size_t> idSetting() const noexcept override;

 private:
  int id_;
};

}  // namespace rc10
