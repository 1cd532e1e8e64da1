#include "sightline/core/estimators/noga_bank.h"

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "support/covariances.h"

namespace sightline::core {
namespace {

using Kind = ResponseModel::Kind;
using Matrix8d = Eigen::Matrix<double, 8, 8>;
using Vector8d = Eigen::Matrix<double, 8, 1>;

/// The belief of one model number, unlike that of the others; channels and components are correlated.
ResponseBelief someBelief(int number) {
  std::mt19937_64 random(static_cast<std::uint64_t>(number + 1));
  std::normal_distribution<double> normal;
  const Matrix8d root = Matrix8d::NullaryExpr([&] { return normal(random); });
  const Vector8d sigmas = (Vector8d() << 0.01, 0.03, 0.1, 0.7, 0.02, 0.03, 0.1, 0.7).finished();
  const Matrix8d P = sigmas.asDiagonal() * (root * root.transpose() / 8.0) * sigmas.asDiagonal();
  ResponseBelief belief;
  belief.mean[0] << 0.1 + 0.002 * number, 0.2, 0.05, 2.0 - 0.1 * number;
  belief.mean[1] << 0.3, -0.1 + 0.01 * number, 0.02, 3.0;
  belief.covariance[0] = P.topLeftCorner<4, 4>();
  belief.covariance[1] = P.bottomRightCorner<4, 4>();
  belief.cross = P.topRightCorner<4, 4>();
  belief.noise << 0.5 + 0.1 * number, 2.0;
  return belief;
}

Matrix8d covarianceOf(const ResponseBelief& belief) {
  Matrix8d P;
  P << belief.covariance[0], belief.cross, belief.cross.transpose(), belief.covariance[1];
  return P;
}

Vector8d meanOf(const ResponseBelief& belief) {
  return (Vector8d() << belief.mean[0], belief.mean[1]).finished();
}

/// Without the covariances of azimuth with elevation where channels are apart.
Matrix8d keptOf(Matrix8d covariance, bool is_coupled) {
  if (is_coupled) return covariance;
  covariance.topRightCorner<4, 4>().setZero();
  covariance.bottomLeftCorner<4, 4>().setZero();
  return covariance;
}

ResponseBank bankOf(int models, bool is_coupled) {
  ResponseBank bank(models);
  for (int model = 0; model < models; ++model) {
    ResponseBelief belief = someBelief(model);
    if (!is_coupled) belief.cross.setZero();
    bank.setBelief(model, belief);
  }
  return bank;
}

ModeArray sharesOf(int models) {
  ModeArray shares(models);
  for (int model = 0; model < models; ++model) shares(model) = 1.0 + model;
  return shares / shares.sum();
}

const BankAmplitude kAmplitude{{0.01 * 0.01, 0.02 * 0.02}, true};

class Banks : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Coupled, Banks, testing::Bool());

TEST_P(Banks, KeepTheBeliefsOfTheirModels) {
  const ResponseBank bank = bankOf(7, true);
  for (int model = 0; model < 7; ++model) {
    EXPECT_EQ(meanOf(bank.belief(model)), meanOf(someBelief(model)));
    EXPECT_EQ(bank.belief(model).cross, someBelief(model).cross);
    EXPECT_TRUE(covarianceOf(bank.belief(model)).isApprox(covarianceOf(someBelief(model)), 1e-15));
    EXPECT_EQ(bank.belief(model).noise, someBelief(model).noise);
  }
}

TEST_P(Banks, MixtureHasTheMomentsOfItsParts) {
  const bool is_coupled = GetParam();
  for (const int models : {1, 4, 6, 13, 16}) {
    const ResponseBank bank = bankOf(models, is_coupled);
    const ModeArray weights = sharesOf(models);
    Vector8d mean = Vector8d::Zero();
    Matrix8d covariance = Matrix8d::Zero();
    for (int model = 0; model < models; ++model) mean += weights(model) * meanOf(bank.belief(model));
    for (int model = 0; model < models; ++model) {
      const Vector8d offset = meanOf(bank.belief(model)) - mean;
      covariance += weights(model) * (covarianceOf(bank.belief(model)) + offset * offset.transpose());
    }
    const ResponseBelief all = bank.mixture(weights, is_coupled);
    EXPECT_TRUE(meanOf(all).isApprox(mean, 1e-14)) << models;
    EXPECT_TRUE(covarianceOf(all).isApprox(keptOf(covariance, is_coupled), 1e-13)) << models;
    EXPECT_NEAR(all.noise(1), 2.0, 1e-14);
    EXPECT_TRUE(bank.noise(weights).isApprox(all.noise, 1e-14));
    const AngularState motion = bank.motion(weights);
    EXPECT_NEAR(motion.mean(3), mean(5), 1e-15) << "the elevation's rate";
    EXPECT_NEAR(motion.covariance(0, 2), covariance(0, 1), 1e-16);
  }
}

TEST_P(Banks, InteractionMixesEachWithAll) {
  const bool is_coupled = GetParam();
  ResponseBank bank = bankOf(6, is_coupled);
  const ResponseBelief all = bank.mixture(sharesOf(6), is_coupled);
  ModeArray own(6);
  own << 1.0, 0.9, 0.5, 0.3, 0.1, 0.0;
  const ResponseBank before = bank;
  bank.interact(own, all, is_coupled);
  for (int model = 0; model < 6; ++model) {
    const double share = own(model);
    const Vector8d offset = meanOf(before.belief(model)) - meanOf(all);
    Matrix8d expected = share * covarianceOf(before.belief(model)) + (1.0 - share) * covarianceOf(all) +
                        share * (1.0 - share) * offset * offset.transpose();
    EXPECT_TRUE(meanOf(bank.belief(model)).isApprox(meanOf(all) + share * offset, 1e-14)) << model;
    EXPECT_TRUE(covarianceOf(bank.belief(model)).isApprox(keptOf(expected, is_coupled), 1e-13)) << model;
  }
}

TEST_P(Banks, StepIsThatOfEachModel) {
  const bool is_coupled = GetParam();
  const std::vector<ResponseModel> models = defaultResponseModels();
  const int count = static_cast<int>(models.size());
  for (const double h : {-0.2, 0.0, 0.03, 2.5}) {
    for (const double unit : {1.0, 4.0}) {
      ResponseBank bank = bankOf(count, is_coupled);
      const ResponseBank before = bank;
      bank.step(models, h, unit, kAmplitude, is_coupled);
      for (int model = 0; model < count; ++model) {
        const Eigen::Vector4d scale(1.0, unit, unit * unit, unit * unit);  // to units of time
        const ResponseBelief belief = before.belief(model);
        Matrix8d F = Matrix8d::Zero(), Q = Matrix8d::Zero();
        for (int c = 0; c < 2; ++c) {
          const Transition one =
              transitionOf(models[static_cast<std::size_t>(model)], scale.asDiagonal() * belief.mean[c], h);
          Eigen::Matrix4d noise = one.Q;
          noise.topLeftCorner<3, 3>() *= kAmplitude.squared(c) * belief.noise(c);
          const auto back = scale.cwiseInverse().asDiagonal();
          F.block<4, 4>(4 * c, 4 * c) = back * one.F * scale.asDiagonal();
          Q.block<4, 4>(4 * c, 4 * c) = back * noise * back;
          Eigen::Vector4d mean = one.F * (scale.asDiagonal() * belief.mean[c]);
          if (models[static_cast<std::size_t>(model)].kind == Kind::harmonic)
            mean = one.mean;  // in kappa it is not linear
          mean(3) = one.mean(3);
          EXPECT_TRUE(bank.belief(model).mean[c].isApprox(back * mean, 1e-12)) << model << ", h = " << h;
        }
        const Matrix8d P = F * keptOf(covarianceOf(belief), is_coupled) * F.transpose() + Q;
        EXPECT_TRUE(covarianceOf(bank.belief(model)).isApprox(P, 1e-11)) << model << ", h = " << h;
        EXPECT_GE(test::leastEigenvalue(covarianceOf(bank.belief(model))), -1e-12 * P.trace());
      }
    }
  }
}

TEST_P(Banks, ReductionIsTheKalmanUpdateWhereTheSightingIsTaken) {
  const bool is_coupled = GetParam();
  ResponseBank bank = bankOf(6, is_coupled);
  const ResponseBank before = bank;
  Measurement sighting;
  sighting.position << 0.11, 0.31;
  sighting.covariance << 4e-4, is_coupled ? 2e-4 : 0.0, is_coupled ? 2e-4 : 0.0, 2e-4;
  NoiseLearningParams as_stated;
  as_stated.enabled = false;
  const ModeArray found = bank.reduce(sighting, SoftGate{}, NoiseLearning(as_stated), kAmplitude, is_coupled);
  for (int model = 0; model < 6; ++model) {
    const ResponseBelief belief = before.belief(model);
    const Matrix8d P = covarianceOf(belief);
    Eigen::Matrix<double, 2, 8> H = Eigen::Matrix<double, 2, 8>::Zero();
    H(0, 0) = H(1, 4) = 1.0;
    const Eigen::Matrix2d R = noiseCovariance(sighting.covariance, belief.noise);
    const Eigen::Matrix2d S = H * P * H.transpose() + R;
    const Eigen::Matrix<double, 8, 2> K = P * H.transpose() * S.inverse();
    const Eigen::Vector2d nu = sighting.position - H * meanOf(belief);
    EXPECT_TRUE(meanOf(bank.belief(model)).isApprox(meanOf(belief) + K * nu, 1e-12));
    EXPECT_TRUE(covarianceOf(bank.belief(model)).isApprox(P - K * S * K.transpose(), 1e-11));
    const double log_likelihood = -0.5 * (nu.dot(S.inverse() * nu) + std::log((2.0 * kPi * S).determinant()));
    EXPECT_NEAR(found(model), log_likelihood, 1e-11);
  }
}

TEST_P(Banks, AnUnlikelySightingIsTakenByItsShareAlone) {  // (S-28)
  const bool is_coupled = GetParam();
  ResponseBank bank = bankOf(5, is_coupled);
  const ResponseBank before = bank;
  Measurement sighting;
  sighting.position << 0.2, 0.34;
  sighting.covariance << 4e-4, is_coupled ? 1e-4 : 0.0, is_coupled ? 1e-4 : 0.0, 4e-4;
  const SoftGate gate{0.05, 4.0};
  NoiseLearningParams as_stated;
  as_stated.enabled = false;
  bank.reduce(sighting, gate, NoiseLearning(as_stated), kAmplitude, is_coupled);
  for (int model = 0; model < 5; ++model) {
    const ResponseBelief belief = before.belief(model), after = bank.belief(model);
    const Matrix8d P = covarianceOf(belief);
    Eigen::Matrix<double, 2, 8> H = Eigen::Matrix<double, 2, 8>::Zero();
    H(0, 0) = H(1, 4) = 1.0;
    const Eigen::Matrix2d S = H * P * H.transpose() + noiseCovariance(sighting.covariance, belief.noise);
    const Eigen::Matrix<double, 8, 2> K = P * H.transpose() * S.inverse();
    const Eigen::Vector2d nu = sighting.position - H * meanOf(belief);
    const auto width = [&](int c) {
      return std::max(gate.outlier_width * std::sqrt(kAmplitude.squared(c) * belief.noise(c)),
                      20.0 * std::sqrt(S(c, c)));
    };
    const auto taken = [&](double log_likelihood, double outliers) {
      const double genuine = 0.95 * std::exp(log_likelihood);
      return genuine / (genuine + 0.05 / outliers);
    };
    Eigen::Vector2d share;
    if (is_coupled) {
      share.setConstant(taken(-0.5 * (nu.dot(S.inverse() * nu) + std::log((2.0 * kPi * S).determinant())),
                              width(0) * width(1)));
    } else {
      for (int c = 0; c < 2; ++c)
        share(c) = taken(-0.5 * (nu(c) * nu(c) / S(c, c) + std::log(2.0 * kPi * S(c, c))), width(c));
    }
    EXPECT_LT(share(0), 0.9999);
    const Vector8d shift = K * nu;
    const Matrix8d reduced = P - K * S * K.transpose();
    for (int c = 0; c < 2; ++c) {
      const Eigen::Vector4d own = shift.segment<4>(4 * c);
      EXPECT_TRUE(after.mean[c].isApprox(belief.mean[c] + share(c) * own, 1e-11));
      const Eigen::Matrix4d expected = (1.0 - share(c)) * belief.covariance[c] +
                                       share(c) * reduced.block<4, 4>(4 * c, 4 * c) +
                                       share(c) * (1.0 - share(c)) * own * own.transpose();
      EXPECT_TRUE(after.covariance[c].isApprox(expected, 1e-11));
    }
    EXPECT_GT(test::leastEigenvalue(covarianceOf(after)), 0.0);
  }
}

}  // namespace
}  // namespace sightline::core
