#pragma once

#include <array>

#include "bus/i_protocol.hpp"
#include "module/stamped.hpp"

namespace rc10 {

/// Rates of the sensor about its own axes.
struct ImuRates {
  float x_deg_s = 0.0F;
  float y_deg_s = 0.0F;
  float z_deg_s = 0.0F;
};

/// Along the sensor's own axes, with gravity.
struct ImuAcceleration {
  float x_m_s2 = 0.0F;
  float y_m_s2 = 0.0F;
  float z_m_s2 = 0.0F;
};

/// As the sensor defines them; makers differ in the order of the rotations.
struct ImuAngles {
  float roll_deg = 0.0F;
  float pitch_deg = 0.0F;
  float yaw_deg = 0.0F;  ///< -180 to 180
};

/// m/s^2 for an acceleration of 1 g.
inline constexpr float kStandardGravity = 9.80665F;

/// A stream of an inertial sensor that computes its orientation itself. Values that a sensor does not send
/// have no samples.
class ImuProtocol : public I_Protocol {
 public:
  [[nodiscard]] const Stamped<ImuAngles>& angles() const noexcept { return angles_; }
  [[nodiscard]] const Stamped<ImuRates>& rates() const noexcept { return rates_; }
  [[nodiscard]] const Stamped<ImuAcceleration>& acceleration() const noexcept { return acceleration_; }
  /// w, x, y, z
  [[nodiscard]] const Stamped<std::array<float, 4>>& quaternion() const noexcept { return quaternion_; }

 protected:
  Stamped<ImuAngles> angles_;
  Stamped<ImuRates> rates_;
  Stamped<ImuAcceleration> acceleration_;
  Stamped<std::array<float, 4>> quaternion_;
};

}  // namespace rc10
