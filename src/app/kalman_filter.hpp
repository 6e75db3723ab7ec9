#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace rc10 {

/// Linear Kalman filter with N states and M numbers in a measurement, on matrices of fixed size: nothing
/// is allocated. Models are arguments, so they may change with dt, and a measurement may be left out.
///
/// The covariance is updated in Joseph's form and stays symmetric and positive even where rounding would
/// spoil the short form (Bucy, Joseph: Filtering for Stochastic Processes). A step whose
/// result would not be finite is refused and changes nothing.
template <int N, int M>
class KalmanFilter {
  static_assert(N > 0 && M > 0, "fixed sizes");

 public:
  using State = Eigen::Matrix<double, N, 1>;
  using StateMatrix = Eigen::Matrix<double, N, N>;
  using Measurement = Eigen::Matrix<double, M, 1>;
  using MeasurementMatrix = Eigen::Matrix<double, M, M>;
  using Observation = Eigen::Matrix<double, M, N>;

  KalmanFilter() = default;
  KalmanFilter(const State& state, const StateMatrix& covariance) noexcept { (void)start(state, covariance); }

  /// Initial estimate. False: refused, since it is not finite.
  bool start(const State& state, const StateMatrix& covariance) noexcept {
    if (!state.allFinite() || !covariance.allFinite()) return false;
    state_ = state;
    covariance_ = covariance;
    return true;
  }

  /// The state moves on: x = F x + push, P = F P F' + Q. False: refused.
  bool predict(const StateMatrix& transition, const StateMatrix& process_noise,
               const State& push = State::Zero()) noexcept {
    const State state = transition * state_ + push;
    const StateMatrix covariance = transition * covariance_ * transition.transpose() + process_noise;
    return start(state, symmetric(covariance));
  }

  /// A measurement z = H x with covariance R. `gate`: one whose normalised innovation squared (about M
  /// in the mean; 11.3 is exceeded once in a hundred for M = 3, 6.6 for M = 1) is larger is refused as
  /// wrong. False: refused.
  bool update(const Measurement& measured, const Observation& observation, const MeasurementMatrix& noise,
              double gate = std::numeric_limits<double>::infinity()) noexcept {
    const Eigen::Matrix<double, N, M> cross = covariance_ * observation.transpose();
    const MeasurementMatrix innovation_covariance = observation * cross + noise;
    const Measurement innovation = measured - observation * state_;
    if (!innovation_covariance.allFinite() || !innovation.allFinite()) return false;
    const Eigen::LLT<MeasurementMatrix> root(innovation_covariance);
    if (root.info() != Eigen::Success) return false;
    normalised_innovation_squared_ = innovation.dot(root.solve(innovation));
    if (!(normalised_innovation_squared_ <= gate)) return false;

    const Eigen::Matrix<double, N, M> gain = root.solve(cross.transpose()).transpose();
    const StateMatrix left = StateMatrix::Identity() - gain * observation;
    const State state = state_ + gain * innovation;
    const StateMatrix covariance = left * covariance_ * left.transpose() + gain * noise * gain.transpose();
    return start(state, symmetric(covariance));
  }

  [[nodiscard]] const State& state() const noexcept { return state_; }
  [[nodiscard]] const StateMatrix& covariance() const noexcept { return covariance_; }
  /// Distance of the last measurement, taken or not, from the expected one.
  [[nodiscard]] double normalisedInnovationSquared() const noexcept { return normalised_innovation_squared_; }

 private:
  [[nodiscard]] static StateMatrix symmetric(const StateMatrix& matrix) noexcept {
    return 0.5 * (matrix + matrix.transpose());
  }

  State state_ = State::Zero();
  StateMatrix covariance_ = StateMatrix::Identity();
  double normalised_innovation_squared_ = 0.0;
};

}  // namespace rc10
