#include "sightline/core/model/tracklet.h"

#include <cmath>
#include <ctime>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector4d;

constexpr double kSigma = 1e-5;  // [rad]: so small that the sphere is flat

Tracklet sightingAt(double t, const Vector2d& angles, const Matrix2d& R) {
  Tracklet sighting;
  sighting.time = Time(std::chrono::seconds(100)) + durationOf(t);
  sighting.sensor = "camera";
  sighting.ifov = 1e-4;
  sighting.sighting = sightingOf(angles, R);
  return sighting;
}

double timeOf(const Tracklet& tracklet) {
  return seconds(tracklet.time - Time(std::chrono::seconds(100)));
}

Matrix2d round(double sigma) {
  return sigma * sigma * Matrix2d::Identity();
}

/// Sightings about the origin at irregular times over `duration` [s], of a target on `path` [sigma].
template <typename Path, typename Noise>
std::vector<Tracklet> sightingsOf(const Path& path, const Noise& R_at, double duration, unsigned seed,
                                  double noise = 1.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> interval(0.002, 0.03);
  std::vector<Tracklet> sightings;
  for (double t = 0.0; t <= duration; t += interval(random)) {
    const Matrix2d R = R_at(t);
    const Vector2d error = R.llt().matrixL() * Vector2d(normal(random), normal(random));
    sightings.push_back(sightingAt(t, kSigma * Vector2d(path(t)) + noise * error, R));
  }
  return sightings;
}

Vector2d still(double) {
  return {1.0, -2.0};
}

Vector2d straight(double t) {
  return {3.0 - 40.0 * t, 25.0 * t};
}

Matrix2d coupled(double t) {
  const Matrix2d shape = (Matrix2d() << 1.0, 0.6, 0.6, 2.0).finished();
  return kSigma * kSigma * (1.0 + 5.0 * t) * shape;  // one shape, grown with time
}

/// What the sightings say of a straight line, (angles, rates) at t = 0.1 s: information and its product with
/// the estimate, in units of the sigma.
struct LineInformation {
  Matrix4d matrix = Matrix4d::Zero();
  Vector4d vector = Vector4d::Zero();
};

LineInformation lineInformation(const std::vector<Tracklet>& sightings) {
  LineInformation all;
  for (const Tracklet& sighting : sightings) {
    Eigen::Matrix<double, 2, 4> H;
    H << Matrix2d::Identity(), (timeOf(sighting) - 0.1) * Matrix2d::Identity();
    const Matrix2d Y = (anglesCovariance(sighting.sighting) / (kSigma * kSigma)).inverse();
    all.matrix += H.transpose() * Y * H;
    all.vector += H.transpose() * Y * (anglesOf(sighting.sighting.direction) / kSigma);
  }
  return all;
}

double countOf(const std::vector<Tracklet>& tracklets) {
  double count = 0.0;
  for (const Tracklet& tracklet : tracklets) count += tracklet.sightings;
  return count;
}

TEST(Tracklet, TwoNodesKeepAllThatTheSightingsSayOfAStraightLine) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto sightings = sightingsOf(straight, coupled, 0.15, seed);
    const auto tracklets = compress(sightings, {0.2, 2});
    if (tracklets.size() > 2) continue;  // one in a hundred is taken for bent
    ASSERT_EQ(tracklets.size(), 2u);
    const LineInformation before = lineInformation(sightings), after = lineInformation(tracklets);
    EXPECT_TRUE(after.matrix.isApprox(before.matrix, 1e-7)) << after.matrix << "\n\n" << before.matrix;
    EXPECT_TRUE(after.vector.isApprox(before.vector, 1e-7)) << after.vector << "\n\n" << before.vector;
    EXPECT_NEAR(countOf(tracklets), static_cast<double>(sightings.size()), 1e-9);
    EXPECT_EQ(tracklets[1].sensor, "camera");
    EXPECT_EQ(tracklets[1].ifov, 1e-4);
    EXPECT_LT(tracklets[0].time, tracklets[1].time);
  }
}

TEST(Tracklet, WeightsInTimeAgreeInAllMomentsThatTheNodesCanMatch) {
  for (const int nodes : {1, 2, 3, 4}) {
    const auto sightings = sightingsOf(still, coupled, 0.15, 3, 0.0);
    const auto tracklets = compress(sightings, {0.2, nodes});
    ASSERT_EQ(tracklets.size(), static_cast<std::size_t>(nodes));
    for (int power = 0; power < 2 * nodes; ++power) {
      double before = 0.0, after = 0.0;
      for (const auto& it : sightings)
        before += std::pow(10.0 * timeOf(it), power) / anglesCovariance(it.sighting)(0, 0);
      for (const auto& it : tracklets)
        after += std::pow(10.0 * timeOf(it), power) / anglesCovariance(it.sighting)(0, 0);
      EXPECT_NEAR(after / before, 1.0, 1e-6) << "S_" << power << " of " << nodes;
    }
  }
}

TEST(Tracklet, OneNodeIsTheCentroid) {
  const auto sightings = sightingsOf(
      still, [](double) { return round(kSigma); }, 0.1, 4);
  const auto tracklets = compress(sightings, {0.2, 1});
  ASSERT_EQ(tracklets.size(), 1u);
  double time = 0.0;
  Vector2d angles = Vector2d::Zero();
  const double n = static_cast<double>(sightings.size());
  for (const auto& sighting : sightings) {
    time += timeOf(sighting) / n;
    angles += anglesOf(sighting.sighting.direction) / n;
  }
  EXPECT_NEAR(timeOf(tracklets[0]), time, 1e-8);
  EXPECT_TRUE(anglesOf(tracklets[0].sighting.direction).isApprox(angles, 1e-6));
  EXPECT_TRUE(anglesCovariance(tracklets[0].sighting).isApprox(round(kSigma / std::sqrt(n)), 1e-6));
}

TEST(Tracklet, ErrorsAreAsStatedAndIndependent) {
  // Two tracklets of a straight line: four errors in units of their sigmas, of covariance one.
  Matrix4d sum = Matrix4d::Zero();
  int runs = 0;
  for (unsigned seed = 1; seed <= 3000; ++seed) {
    const auto tracklets = compress(sightingsOf(straight, coupled, 0.15, seed), {0.2, 2});
    if (tracklets.size() != 2) continue;
    Vector4d errors;
    for (int k = 0; k < 2; ++k) {
      const auto& tracklet = tracklets[static_cast<std::size_t>(k)];
      const Vector2d error = anglesOf(tracklet.sighting.direction) - kSigma * straight(timeOf(tracklet));
      errors.segment<2>(2 * k) = anglesCovariance(tracklet.sighting).llt().matrixL().solve(error);
    }
    sum += errors * errors.transpose();
    ++runs;
  }
  // Standard errors: root(2/n) on the diagonal and root(1/n) beside it; five of them.
  const Matrix4d mean = sum / runs;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_NEAR(mean(row, column), row == column ? 1.0 : 0.0, 5.0 * std::sqrt(2.0 / runs));
    }
  }
  EXPECT_GT(runs, 2900) << "about one in a hundred may be taken for bent";
}

TEST(Tracklet, SteadyAccelerationDoesNotBiasTwoNodes) {
  const auto parabola = [](double t) { return Vector2d(40.0 * t * t, -25.0 * t * t); };
  const auto sightings = sightingsOf(
      parabola, [](double) { return round(kSigma); }, 0.2, 5, 0.0);
  const auto tracklets = compress(sightings, {0.3, 2});
  ASSERT_EQ(tracklets.size(), 2u) << "half a sigma of bend is not seen";
  for (const Tracklet& tracklet : tracklets) {
    const Vector2d error = anglesOf(tracklet.sighting.direction) / kSigma - parabola(timeOf(tracklet));
    EXPECT_LT(error.norm(), 1e-5);
  }
}

TEST(Tracklet, PathThatIsSeenToBendIsTakenInFinerPieces) {
  const auto jink = [](double t) { return Vector2d(300.0 * std::abs(t - 0.07), 0.0); };
  const auto sightings = sightingsOf(
      jink, [](double) { return round(kSigma); }, 0.15, 6);
  const auto tracklets = compress(sightings, {0.2, 2});
  EXPECT_GT(tracklets.size(), 2u);
  EXPECT_LE(tracklets.size(), sightings.size());
  for (const Tracklet& tracklet : tracklets) {
    const double miss = (anglesOf(tracklet.sighting.direction) / kSigma - jink(timeOf(tracklet))).norm();
    EXPECT_LT(miss, 5.0 * std::sqrt(anglesCovariance(tracklet.sighting)(0, 0)) / kSigma) << timeOf(tracklet);
  }
}

TEST(Tracklet, CovariancesOfChangingShapeLoseNothingWorthNaming) {
  // The first half sees azimuth ten times better than elevation, the second half the other way round.
  const auto turning = [](double t) {
    const double a = t < 0.07 ? kSigma : 10.0 * kSigma, b = t < 0.07 ? 10.0 * kSigma : kSigma;
    return Matrix2d(Vector2d(a * a, b * b).asDiagonal());
  };
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto sightings = sightingsOf(straight, turning, 0.15, seed);
    const auto tracklets = compress(sightings, {0.2, 2});
    EXPECT_LT(tracklets.size(), sightings.size());
    const Matrix4d before = lineInformation(sightings).matrix, after = lineInformation(tracklets).matrix;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix4d> ratio(after, before);
    EXPECT_GT(ratio.eigenvalues()(0), 0.95);
    EXPECT_LT(ratio.eigenvalues()(3), 1.05) << "no information comes from nowhere";
  }
}

TEST(Tracklet, FewSightingsAndSpanZeroStayAsTheyAre) {
  const auto sightings = sightingsOf(straight, coupled, 0.15, 7);
  const std::vector<Tracklet> two(sightings.begin(), sightings.begin() + 2);
  EXPECT_TRUE(compress({}, {0.2, 2}).empty());
  for (const auto& [few, params] : {std::make_pair(two, CompressionParams{0.2, 2}),
                                    std::make_pair(sightings, CompressionParams{0.0, 2})}) {
    const auto same = compress(few, params);
    ASSERT_EQ(same.size(), few.size());
    for (std::size_t i = 0; i < few.size(); ++i) {
      EXPECT_EQ(same[i].time, few[i].time);
      EXPECT_EQ(same[i].sighting.direction, few[i].sighting.direction);
      EXPECT_EQ(same[i].sighting.covariance, few[i].sighting.covariance);
      EXPECT_EQ(same[i].sightings, 1.0);
    }
  }
}

TEST(Tracklet, LongReportIsDividedIntoEqualSpans) {
  const auto sightings = sightingsOf(straight, coupled, 1.0, 8);
  const auto tracklets = compress(sightings, {0.25, 2});
  EXPECT_GE(tracklets.size(), 8u);
  EXPECT_LE(tracklets.size(), 12u) << "a span that is taken for bent counts double";
  EXPECT_NEAR(countOf(tracklets), static_cast<double>(sightings.size()), 1e-9);
}

TEST(Tracklet, SightingsOfOneInstantBecomeTheirMean) {
  std::vector<Tracklet> sightings(3, sightingAt(0.1, {0.2, 0.3}, round(kSigma)));
  EXPECT_EQ(compress(sightings, {0.2, 2}).size(), 3u) << "there is no span; they stay as they are";
  sightings.push_back(sightingAt(0.2, {0.2, 0.3}, round(kSigma)));
  const auto tracklets = compress(sightings, {0.2, 2});
  ASSERT_EQ(tracklets.size(), 2u);
  EXPECT_NEAR(tracklets[0].sightings, 3.0, 1e-6);
  EXPECT_NEAR(timeOf(tracklets[0]), 0.1, 1e-8);
}

TEST(Tracklet, PlaceOnTheSphereDoesNotMatter) {
  const auto sightings = sightingsOf([](double t) { return Vector2d(4000.0 * t, 9000.0 * t); }, coupled, 0.15,
                                     9);  // half a degree in the span
  const auto plain = compress(sightings, {0.2, 2});
  std::vector<Eigen::Matrix3d> places;
  for (const double azimuth : {1.0, 3.14159, -2.0})
    places.push_back(Eigen::AngleAxisd(azimuth, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  for (const double tilt : {0.5, 1.5707, -1.5})  // to the zenith and to the nadir
    places.push_back(
        Eigen::AngleAxisd(tilt, Eigen::Vector3d(0.1, -1.0, 0.2).normalized()).toRotationMatrix());
  for (const Eigen::Matrix3d& R : places) {
    std::vector<Tracklet> turned = sightings;
    for (Tracklet& sighting : turned) sighting.sighting = rotate(sighting.sighting, R);
    const auto tracklets = compress(turned, {0.2, 2});
    ASSERT_EQ(tracklets.size(), plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) {
      const Sighting expected = rotate(plain[i].sighting, R);
      EXPECT_LT(seconds(std::chrono::abs(tracklets[i].time - plain[i].time)), 1e-5);
      EXPECT_LT(angleBetween(tracklets[i].sighting.direction, expected.direction), 0.02 * kSigma);
      EXPECT_TRUE(tracklets[i].sighting.covariance.isApprox(expected.covariance, 1e-3));
    }
  }
}

TEST(Tracklets, APauseOfYearsTakesNoLongerThanOneOfSeconds) {
  std::vector<Tracklet> sightings;
  for (const double begin : {0.0, 1e8}) {
    for (int i = 0; i < 20; ++i)
      sightings.push_back(sightingAt(begin + 0.01 * i, kSigma * straight(0.01 * i), round(kSigma)));
  }
  const std::clock_t before = std::clock();
  const auto tracklets = compress(sightings, {0.15, 2});
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC,
            0.5);  // hundreds of millions of spans: 4 s
  ASSERT_GE(tracklets.size(), 4u);
  double count = 0.0;
  for (const Tracklet& tracklet : tracklets) {
    EXPECT_TRUE(timeOf(tracklet) < 1.0 || timeOf(tracklet) > 1e8 - 1.0) << timeOf(tracklet);
    count += tracklet.sightings;
  }
  EXPECT_NEAR(40.0, count, 1e-9);
}

}  // namespace
}  // namespace sightline::core
