#pragma once

#include "drives/robstride/robstride_frames.hpp"
#include "motor/drive_setup.hpp"

namespace rc10 {

/// Settings that can be written to a RobStride drive, or to a CyberGear: that has no frame to store
/// parameters (its type 22 is another bit rate), so only its id.
[[nodiscard]] const DriveSetup& robstrideSetup(bool cyber_gear) noexcept;

/// The parameters of one drive as settings.
class RobstrideSetupCodec final : public DriveCodec {
 public:
  explicit RobstrideSetupCodec(const robstride::Codec& codec) noexcept : codec_(codec) {}

  [[nodiscard]] const DriveSetup& setup() const noexcept override {
    return robstrideSetup(codec_.model->cyber_gear);
  }
  [[nodiscard]] CanFrame write(const DriveValue& value) const noexcept override;
  [[nodiscard]] std::optional<CanFrame> read(std::size_t setting) const noexcept override;
  [[nodiscard]] std::optional<double> reading(std::size_t setting,
                                              const CanFrame& frame) const noexcept override;
  [[nodiscard]] std::optional<CanFrame> save(std::optional<int> new_id) const noexcept override;
  /// It answers with its state, as to everything: that it is alive after storing is all there is to see.
  [[nodiscard]] bool saysSaved(const CanFrame& frame) const noexcept override;
  [[nodiscard]] std::optional<std::size_t> idSetting() const noexcept override { return 0; }

 private:
  robstride::Codec codec_;
};

}  // namespace rc10
