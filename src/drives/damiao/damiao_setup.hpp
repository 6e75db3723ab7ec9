#pragma once

#include "drives/damiao/damiao_frames.hpp"
#include "motor/drive_setup.hpp"

namespace rc10 {

/// Settings that can be written to a Damiao drive: some of its registers.
[[nodiscard]] const DriveSetup& damiaoSetup() noexcept;

/// The registers of one drive as settings.
class DamiaoSetupCodec final : public DriveCodec {
 public:
  DamiaoSetupCodec(int id, bool can_fd) noexcept : id_(id), can_fd_(can_fd) {}

  [[nodiscard]] const DriveSetup& setup() const noexcept override { return damiaoSetup(); }
  [[nodiscard]] CanFrame write(const DriveValue& value) const noexcept override;
  [[nodiscard]] std::optional<CanFrame> read(std::size_t setting) const noexcept override;
  [[nodiscard]] std::optional<double> reading(std::size_t setting,
                                              const CanFrame& frame) const noexcept override;
  [[nodiscard]] std::optional<CanFrame> save(std::optional<int> new_id) const noexcept override;
  [[nodiscard]] bool saysSaved(const CanFrame& frame) const noexcept override;
  [[nodiscard]] std::optional<std::size_t> idSetting() const noexcept override;

 private:
  [[nodiscard]] CanFrame toRegisters(const damiao::Payload& payload) const noexcept;

  int id_;
  bool can_fd_;
};

}  // namespace rc10
