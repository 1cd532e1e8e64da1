#include "sightline/core/association/equivalent_sighting.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "sightline/core/association/joint_association.h"
#include "sightline/core/model/kinematics.h"

namespace sightline::core {
namespace {

using Sightings = std::vector<PossibleSighting>;

struct Gaussian {
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
};

/// The textbook's update with one sighting of the position (first two of the state).
Gaussian updated(const Gaussian& prior, const Eigen::Vector2d& innovation, const Eigen::Matrix2d& R) {
  const Eigen::Matrix2d S = prior.covariance.topLeftCorner<2, 2>() + R;
  const Eigen::Matrix<double, 4, 2> K = prior.covariance.leftCols<2>() * S.inverse();
  Gaussian posterior;
  posterior.mean = prior.mean + K * innovation;
  posterior.covariance = prior.covariance - K * S * K.transpose();
  return posterior;
}

/// The textbook's mixture of the updates by each sighting and by none.
Gaussian mixtureOf(const Gaussian& prior, const Sightings& sightings) {
  std::vector<std::pair<double, Gaussian>> parts;
  double missed = 1.0;
  for (const PossibleSighting& sighting : sightings) {
    parts.emplace_back(sighting.probability, updated(prior, sighting.innovation, sighting.covariance));
    missed -= sighting.probability;
  }
  parts.emplace_back(missed, prior);
  Gaussian mixture;
  mixture.mean.setZero();
  mixture.covariance.setZero();
  for (const auto& [weight, part] : parts) mixture.mean += weight * part.mean;
  for (const auto& [weight, part] : parts) {
    const Eigen::Vector4d apart = part.mean - mixture.mean;
    mixture.covariance += weight * (part.covariance + apart * apart.transpose());
  }
  return mixture;
}

Eigen::MatrixXd randomCovariance(int size, double sigma, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd A(size, size + 2);
  for (Eigen::Index k = 0; k < A.size(); ++k) *(A.data() + k) = sigma * normal(random);
  return A * A.transpose() / (size + 2.0) + 0.05 * sigma * sigma * Eigen::MatrixXd::Identity(size, size);
}

/// One to four sightings whose innovations are within `reach` sigma of P.
Sightings randomSightings(double sigma, double reach, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Sightings sightings(1 + random() % 4);
  double sum = 0.0;
  for (PossibleSighting& sighting : sightings) {
    sighting.covariance = randomCovariance(2, 0.5 * sigma, random);
    sighting.innovation = reach * sigma * Eigen::Vector2d(uniform(random) - 0.5, uniform(random) - 0.5);
    sum += sighting.probability = uniform(random);
  }
  const double detected = 0.3 + 0.7 * uniform(random);
  for (PossibleSighting& sighting : sightings) sighting.probability *= detected / sum;
  return sightings;
}

TEST(EquivalentSighting, OfASureOneIsThatOne) {
  Sightings sure(1);
  sure[0].innovation << 3e-4, -1e-4;
  sure[0].covariance << 4e-8, 1e-8, 1e-8, 2e-8;
  sure[0].probability = 1.0;
  const auto found = equivalentSighting(Eigen::Matrix2d::Identity() * 3e-8, sure);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_exact);
  EXPECT_EQ(found->sightings, 1.0);
  EXPECT_LT((found->innovation - sure[0].innovation).norm(), 1e-14);
  EXPECT_LT((found->covariance - sure[0].covariance).norm(), 1e-18);
}

TEST(EquivalentSighting, UpdateWithItIsTheWholeTextbookPosteriorRatesToo) {
  std::mt19937_64 random(4);
  int exact = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double sigma = std::pow(10.0, -6.0 + trial % 6);
    Gaussian prior;
    prior.covariance = randomCovariance(4, sigma, random);
    const Sightings sightings = randomSightings(sigma, 2.5, random);
    const auto found = equivalentSighting(prior.covariance.topLeftCorner<2, 2>(), sightings);
    ASSERT_TRUE(found);
    const Gaussian expected = mixtureOf(prior, sightings);
    const Gaussian posterior = updated(prior, found->innovation, found->covariance);
    ASSERT_LT((posterior.mean - expected.mean).norm(), 1e-10 * sigma);  // also where it is not exact
    if (!found->is_exact) continue;
    ++exact;
    ASSERT_LT((posterior.covariance - expected.covariance).norm(), 1e-10 * sigma * sigma);
  }
  EXPECT_GT(exact, 1000);
}

TEST(EquivalentSighting, WithSightingsFarApartIsWeakAndKeepsTheMean) {
  std::mt19937_64 random(6);
  int inexact = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Matrix2d P = randomCovariance(2, 1e-4, random);
    const Sightings sightings = randomSightings(1e-4, 16.0, random);
    const auto found = equivalentSighting(P, sightings), again = equivalentSighting(P, sightings);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->innovation, again->innovation);
    ASSERT_EQ(Eigen::LLT<Eigen::Matrix2d>(found->covariance).info(), Eigen::Success);
    const Eigen::Matrix2d S = P + found->covariance;
    const Eigen::Vector2d shift = P * S.inverse() * found->innovation;
    ASSERT_LT((shift - positionAfter(P, sightings)->shift).norm(), 1e-9 * 1e-4);
    if (found->is_exact) continue;
    ++inexact;
    // In the direction that is lost, a twentieth of the variance goes and no more.
    const Eigen::Matrix2d after = P - P * S.inverse() * P;
    const Eigen::Matrix2d share = P.inverse() * after;  // its larger eigenvalue, by trace and determinant
    const double half = 0.5 * share.trace();
    ASSERT_NEAR(half + std::sqrt(std::max(half * half - share.determinant(), 0.0)), 0.95, 1e-6);
  }
  EXPECT_GT(inexact, 500);
}

TEST(EquivalentSighting, IsNoneWhereNothingWasSeenOrInputIsUnusable) {
  const Eigen::Matrix2d P = Eigen::Matrix2d::Identity();
  EXPECT_FALSE(equivalentSighting(P, {}));
  Sightings sightings(1);
  EXPECT_FALSE(equivalentSighting(P, sightings)) << "probability zero";
  sightings[0].probability = 1.5;
  EXPECT_FALSE(equivalentSighting(P, sightings));
  sightings[0].probability = 0.5;
  EXPECT_TRUE(equivalentSighting(P, sightings));
  EXPECT_FALSE(equivalentSighting(-P, sightings));
  sightings[0].innovation.x() = std::nan("");
  EXPECT_FALSE(equivalentSighting(P, sightings));
  sightings[0].innovation.setZero();
  sightings[0].covariance.setZero();
  EXPECT_FALSE(equivalentSighting(P, sightings));
}

// ---- a target in clutter ----------------------------------------------------------------------------------

struct Errors {
  double nees = 0.0;            // mean over the runs, of four states
  double standard_error = 0.0;  // of that mean
  double lost = 0.0;            // share of runs that ended beyond ten sigma
};

constexpr double kInterval = 0.1, kSigma = 1e-3;  // [s], [rad]
constexpr double kDetection = 0.9, kGate = 16.0;

/// Errors at the end of runs of a target among false sightings, `false_per_gate` in the gate of an innovation
/// with twice the variance of a sighting; updated with the equivalent sighting, or with the nearest one.
enum class By { equivalent, textbook, nearest };

Errors errorsInClutter(double false_per_gate, By by) {
  constexpr int kRuns = 5000, kScans = 25;
  const double reach = 30.0 * kSigma;  // clutter falls within so much of the target
  const double density = false_per_gate / (M_PI * kGate * 2.0 * kSigma * kSigma);  // [1/rad^2]
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::poisson_distribution<int> clutter(density * 4.0 * reach * reach);
  const auto draw = [&] { return Eigen::Vector2d(normal(random), normal(random)); };

  const Eigen::Matrix2d acceleration = 2e-4 * Eigen::Matrix2d::Identity();  // [rad^2/s^3]
  std::vector<double> nees;
  int lost = 0;
  for (int run = 0; run < kRuns; ++run) {
    Motion<4> track, process;
    process.covariance.setZero();
    process.mean.setZero();
    addWhiteAcceleration(process, acceleration, kInterval);
    const Eigen::Matrix4d process_root = Eigen::LLT<Eigen::Matrix4d>(process.covariance).matrixL();
    track.mean.setZero();
    track.covariance = Eigen::Vector4d(1.0, 1.0, 100.0, 100.0).asDiagonal() * (kSigma * kSigma);
    Motion<4> truth = track;
    truth.mean << kSigma * draw(), 10.0 * kSigma * draw();
    for (int scan = 0; scan < kScans; ++scan) {
      moveOn(track, kInterval);
      addWhiteAcceleration(track, acceleration, kInterval);
      moveOn(truth, kInterval);
      Eigen::Vector4d kick;
      kick << draw(), draw();
      truth.mean += process_root * kick;

      std::vector<Eigen::Vector2d> seen;
      if (uniform(random) < 2.0 * kDetection - 1.0) seen.push_back(truth.mean.head<2>() + kSigma * draw());
      for (int k = clutter(random); k > 0; --k)
        seen.push_back(truth.mean.head<2>() + reach * Eigen::Vector2d(uniform(random), uniform(random)));

      const Eigen::Matrix2d P = track.covariance.topLeftCorner<2, 2>();
      const Eigen::Matrix2d R = kSigma * kSigma * Eigen::Matrix2d::Identity(), S = P + R;
      std::vector<GatedPair> pairs;
      Sightings sightings;
      std::vector<double> distances;
      for (const Eigen::Vector2d& z : seen) {
        const Eigen::Vector2d innovation = z - track.mean.head<2>();
        const double distance_squared = innovation.dot(S.inverse() * innovation);
        if (distance_squared > kGate) continue;
        const double log_likelihood =
            -0.5 * distance_squared - std::log(2.0 * M_PI * std::sqrt(S.determinant()));
        pairs.push_back({0, static_cast<int>(pairs.size()), std::log(kDetection / density) + log_likelihood});
        sightings.push_back({innovation, R, 0.0});
        distances.push_back(distance_squared);
      }
      if (pairs.empty()) continue;
      if (by == By::nearest) {
        const auto best = std::min_element(distances.begin(), distances.end()) - distances.begin();
        condition(track, (track.mean.head<2>() + sightings[best].innovation).eval(), R);
        continue;
      }
      const double inside = 1.0 - std::exp(-0.5 * kGate);
      const auto probabilities = jointProbabilities(pairs, {1.0 - kDetection * inside});
      for (std::size_t j = 0; j < sightings.size(); ++j) sightings[j].probability = probabilities.paired[j];
      if (by == By::textbook) {
        Gaussian prior{track.mean, track.covariance};
        const Gaussian after = mixtureOf(prior, sightings);
        track.mean = after.mean;
        track.covariance = after.covariance;
        continue;
      }
      const auto equivalent = equivalentSighting(P, sightings);
      if (equivalent)
        condition(track, (track.mean.head<2>() + equivalent->innovation).eval(), equivalent->covariance);
    }
    const Eigen::Vector4d error = track.mean - truth.mean;
    if (error.head<2>().norm() > 10.0 * kSigma * 2.0) {
      ++lost;
      continue;
    }
    nees.push_back(error.dot(Eigen::LLT<Eigen::Matrix4d>(track.covariance).solve(error)));
  }
  Errors errors;
  for (const double value : nees) errors.nees += value / static_cast<double>(nees.size());
  double variance = 0.0;
  for (const double value : nees)
    variance += std::pow(value - errors.nees, 2.0) / static_cast<double>(nees.size());
  errors.standard_error = std::sqrt(variance / static_cast<double>(nees.size()));
  errors.lost = lost / static_cast<double>(kRuns);
  return errors;
}

TEST(EquivalentSighting, TrackInClutterIsConsistentWhereTheNearestIsNot) {
  const Errors joint = errorsInClutter(0.05, By::equivalent);
  const Errors textbook = errorsInClutter(0.05, By::textbook);
  const Errors nearest = errorsInClutter(0.05, By::nearest);
  // E[NEES] = 4 whatever the shape of the posterior, if its mean and covariance are right.
  EXPECT_NEAR(joint.nees, 4.0, 0.1 + 4.0 * joint.standard_error);
  EXPECT_NEAR(textbook.nees, 4.0, 0.1 + 4.0 * textbook.standard_error);
  EXPECT_GT(nearest.nees, 4.0 + 4.0 * nearest.standard_error);
  EXPECT_LT(joint.lost, 0.5 * nearest.lost);
}

}  // namespace
}  // namespace sightline::core
