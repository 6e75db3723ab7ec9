#include "app/kalman_filter.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/LU>

namespace rc10::test::kalman_filter_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Scalar = Eigen::Matrix<double, 1, 1>;

Scalar scalar(double value) { return Scalar::Constant(value); }

TEST(KalmanFilter, OfAConstantIsTheMeanWeightedByTheVariances) {
  KalmanFilter<1, 1> filter(scalar(10.0), scalar(4.0));
  const double measured[] = {12.0, 8.5, 11.0, 9.0};
  double information = 1.0 / 4.0;
  double sum = 10.0 / 4.0;
  for (const double z : measured) {
    EXPECT_TRUE(filter.update(scalar(z), scalar(1.0), scalar(0.5)));
    information += 1.0 / 0.5;
    sum += z / 0.5;
    EXPECT_NEAR(filter.state()(0), sum / information, 1e-12);
    EXPECT_NEAR(filter.covariance()(0), 1.0 / information, 1e-12);
  }
}

TEST(KalmanFilter, OfARandomWalkSettlesOnTheSolutionOfItsRiccatiEquation) {
  constexpr double kQ = 0.3;
  constexpr double kR = 2.0;
  KalmanFilter<1, 1> filter(scalar(0.0), scalar(100.0));
  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(filter.update(scalar(1.0), scalar(1.0), scalar(kR)));
    EXPECT_TRUE(filter.predict(scalar(1.0), scalar(kQ)));
  }
  EXPECT_NEAR(filter.covariance()(0), 0.5 * (kQ + std::sqrt(kQ * kQ + 4.0 * kQ * kR)), 1e-9);
}

/// Position and velocity, driven by noise on the acceleration; the position is measured.
struct ConstantVelocity {
  static constexpr double kDt = 0.01;
  Eigen::Matrix2d transition{{1.0, kDt}, {0.0, 1.0}};
  Eigen::Vector2d push{0.5 * kDt * kDt, kDt};
  Eigen::RowVector2d observation{1.0, 0.0};
};

TEST(KalmanFilter, KnowsHowWrongItIs) {
  const ConstantVelocity model;
  constexpr double kAcceleration = 3.0;
  constexpr double kMeasurement = 0.05;
  std::mt19937 random(42);
  std::normal_distribution<double> normal;
  Eigen::Vector2d truth(0.0, 1.0);
  KalmanFilter<2, 1> filter(truth, 0.01 * Eigen::Matrix2d::Identity());
  double nis = 0.0;
  double nees = 0.0;
  double raw = 0.0;
  double filtered = 0.0;
  constexpr int kSteps = 20'000;
  for (int i = 0; i < kSteps; ++i) {
    truth = model.transition * truth + model.push * kAcceleration * normal(random);
    const double z = truth(0) + kMeasurement * normal(random);
    ASSERT_TRUE(filter.predict(model.transition,
                               model.push * model.push.transpose() * (kAcceleration * kAcceleration)));
    ASSERT_TRUE(filter.update(scalar(z), model.observation, scalar(kMeasurement * kMeasurement)));
    nis += filter.normalisedInnovationSquared();
    const Eigen::Vector2d error = filter.state() - truth;
    nees += error.dot(filter.covariance().inverse() * error);
    raw += (z - truth(0)) * (z - truth(0));
    filtered += error(0) * error(0);
  }
  EXPECT_NEAR(nis / kSteps, 1.0, 0.05);
  EXPECT_NEAR(nees / kSteps, 2.0, 0.3);
  EXPECT_LT(filtered, 0.5 * raw);
}

TEST(KalmanFilter, AKnownPushMovesTheStateAtOnce) {
  const ConstantVelocity model;
  KalmanFilter<2, 1> filter(Eigen::Vector2d(1.0, 2.0), Eigen::Matrix2d::Identity());
  EXPECT_TRUE(filter.predict(model.transition, Eigen::Matrix2d::Zero(), model.push * 10.0));
  EXPECT_NEAR(filter.state()(0), 1.0 + 0.02 + 0.0005, 1e-12);
  EXPECT_NEAR(filter.state()(1), 2.1, 1e-12);
}

TEST(KalmanFilter, ItsCovarianceStaysSymmetricAndPositiveWithMeasurementsFarBetterThanTheState) {
  const ConstantVelocity model;
  KalmanFilter<2, 1> filter(Eigen::Vector2d::Zero(), 1e8 * Eigen::Matrix2d::Identity());
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_TRUE(filter.predict(model.transition, 1e-12 * Eigen::Matrix2d::Identity()));
    ASSERT_TRUE(filter.update(scalar(1.0), model.observation, scalar(1e-12)));
    const Eigen::Matrix2d p = filter.covariance();
    ASSERT_EQ(p(0, 1), p(1, 0));
    // Its smaller eigenvalue.
    ASSERT_GE(0.5 * (p(0, 0) + p(1, 1)), std::hypot(0.5 * (p(0, 0) - p(1, 1)), p(0, 1))) << i;
  }
}

TEST(KalmanFilter, TwoMeasurementsAtOnceAreWorthAsMuchAsOneAfterTheOther) {
  KalmanFilter<2, 2> both(Eigen::Vector2d(1.0, -1.0), Eigen::Matrix2d{{2.0, 0.5}, {0.5, 1.0}});
  KalmanFilter<2, 1> single(both.state(), both.covariance());
  EXPECT_TRUE(both.update({3.0, 0.0}, Eigen::Matrix2d{{1.0, 0.0}, {1.0, 1.0}},
                          Eigen::Vector2d(0.1, 0.2).asDiagonal()));
  EXPECT_TRUE(single.update(scalar(3.0), Eigen::RowVector2d(1.0, 0.0), scalar(0.1)));
  EXPECT_TRUE(single.update(scalar(0.0), Eigen::RowVector2d(1.0, 1.0), scalar(0.2)));
  EXPECT_TRUE(both.state().isApprox(single.state(), 1e-12));
  EXPECT_TRUE(both.covariance().isApprox(single.covariance(), 1e-12));
}

TEST(KalmanFilter, AMeasurementBeyondTheGateIsRefused) {
  KalmanFilter<1, 1> filter(scalar(0.0), scalar(1.0));
  EXPECT_FALSE(filter.update(scalar(10.0), scalar(1.0), scalar(1.0), 6.6));
  EXPECT_NEAR(filter.normalisedInnovationSquared(), 50.0, 1e-9);
  EXPECT_EQ(filter.state()(0), 0.0);
  EXPECT_EQ(filter.covariance()(0), 1.0);
  EXPECT_TRUE(filter.update(scalar(1.0), scalar(1.0), scalar(1.0), 6.6));
}

TEST(KalmanFilter, WhatIsNotFiniteOrNoCovarianceIsRefusedAndChangesNothing) {
  KalmanFilter<1, 1> filter(scalar(5.0), scalar(1.0));
  for (const double bad : {kNan, kInfinity}) {
    EXPECT_FALSE(filter.start(scalar(bad), scalar(1.0)));
    EXPECT_FALSE(filter.predict(scalar(bad), scalar(1.0)));
    EXPECT_FALSE(filter.predict(scalar(1.0), scalar(bad)));
    EXPECT_FALSE(filter.predict(scalar(1.0), scalar(1.0), scalar(bad)));
    EXPECT_FALSE(filter.update(scalar(bad), scalar(1.0), scalar(1.0)));
    EXPECT_FALSE(filter.update(scalar(1.0), scalar(bad), scalar(1.0)));
    EXPECT_FALSE(filter.update(scalar(1.0), scalar(1.0), scalar(bad)));
  }
  EXPECT_FALSE(filter.update(scalar(1.0), scalar(1.0), scalar(-2.0)));
  EXPECT_FALSE(filter.update(scalar(1.0), scalar(0.0), scalar(0.0)));
  EXPECT_FALSE(filter.predict(scalar(1e200), scalar(1.0)));
  EXPECT_EQ(filter.state()(0), 5.0);
  EXPECT_EQ(filter.covariance()(0), 1.0);
}

}  // namespace
}  // namespace rc10::test::kalman_filter_test
