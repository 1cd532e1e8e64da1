#include "sightline/core/positions/stations/station_correction.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/simulation/random_stream.h"

#include "field_views.h"

namespace sightline::core {
namespace {

using test::Fault;
using test::kOrigins;
using test::kRateSigma;
using test::viewOf;
using Vector = Eigen::Vector3d;

constexpr double kSigma = test::kViewSigma;

struct Target {
  Vector position, velocity;
};

Target targetAt(int number, double t) {
  const double phase = 0.5 * t + 2.0 * number;
  return {{45 + 20 * std::cos(phase), 50 + 20 * std::sin(phase), 15 + 8 * number + 5 * std::sin(0.7 * phase)},
          {-10 * std::sin(phase), 10 * std::cos(phase), 1.75 * std::cos(0.7 * phase)}};
}

/// What a station sees, without noise.
Ray rayOf(const Vector& origin, const Target& target, const Vector& turned = Vector::Zero()) {
  const Vector to = target.position - origin;
  const Eigen::Matrix3d R = turned.norm() > 0.0
                                ? Eigen::AngleAxisd(turned.norm(), turned.normalized()).toRotationMatrix()
                                : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  Ray ray;
  ray.origin = origin;
  ray.direction = R * to.normalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
  ray.covariance = kSigma * kSigma * across;
  ray.motion =
      RayMotion{across * (R * target.velocity) / to.norm(), kRateSigma * kRateSigma * across, Vector::Zero()};
  return ray;
}

/// Three targets that fly in circles, one sample a second of each.
void look(StationAlignment& alignment, const std::vector<Fault>& faults, double from, double until,
          RandomStream& random) {
  for (double t = from; t < until; t += 1.0) {
    for (int target = 0; target < 3; ++target) {
      std::vector<Ray> rays;
      for (std::size_t s = 0; s < faults.size(); ++s) {
        Ray ray = rayOf(kOrigins[s], targetAt(target, t - faults[s].clock), faults[s].turned);
        const auto B = acrossBasis(ray.direction);
        ray.direction = (ray.direction + B.transpose() * kSigma * random.normalPair()).normalized();
        ray.motion->rate += B.transpose() * kRateSigma * random.normalPair();
        rays.push_back(ray);
      }
      for (std::size_t a = 0; a < rays.size(); ++a)
        for (std::size_t b = a + 1; b < rays.size(); ++b)
          alignment.take(Time(durationOf(t)), viewOf(a, target, rays[a]), viewOf(b, target, rays[b]),
                         2.0 / static_cast<double>(rays.size()));
    }
  }
}

StationAlignment aligned(const std::vector<Fault>& faults, double duration, std::uint64_t seed) {
  RandomStream random(seed);
  StationAlignment alignment;
  look(alignment, faults, 0.0, duration, random);
  return alignment;
}

StationCorrections corrections() {
  return StationCorrections({}, {});
}

TEST(StationCorrections, FindTheOneStationThatIsOffAndByHowMuchWithAnHonestStandardDeviation) {
  int honest = 0, total = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    std::vector<Fault> faults(4);
    faults[2] = {0.05, {0.002, -0.003, 0.003}};
    StationCorrections found = corrections();
    EXPECT_TRUE(found.decide(aligned(faults, 20.0, seed)));
    for (const int station : {0, 1, 3}) EXPECT_EQ(found.of(station), nullptr) << seed;
    EXPECT_TRUE(found.undecided().empty());
    const StationCorrection* correction = found.of(2);
    ASSERT_NE(correction, nullptr) << seed;
    EXPECT_TRUE(correction->has_clock && correction->has_orientation) << seed;
    const Eigen::Vector4d sigma = correction->covariance.diagonal().cwiseSqrt();
    EXPECT_LT(sigma(0), 0.005);
    total += 4;
    if (std::abs(correction->clock - 0.05) < 3.0 * sigma(0)) ++honest;
    for (int i = 0; i < 3; ++i)
      if (std::abs(correction->orientation(i) - faults[2].turned(i)) < 3.0 * sigma(i + 1)) ++honest;
  }
  EXPECT_GE(honest, total * 95 / 100);
}

TEST(StationCorrections, StationsThatAreRightStayAsTheyAre) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    StationCorrections found = corrections();
    EXPECT_FALSE(found.decide(aligned(std::vector<Fault>(4), 20.0, seed))) << seed;
    for (int station = 0; station < 4; ++station) EXPECT_EQ(found.of(station), nullptr) << seed;
    EXPECT_TRUE(found.undecided().empty()) << seed;
  }
}

TEST(StationCorrections, OnlyWhatIsOffIsCorrected) {
  std::vector<Fault> late(4), turned(4);
  late[1].clock = 0.05;
  turned[1].turned = Vector(0.003, -0.003, 0.003);
  StationCorrections found = corrections();
  found.decide(aligned(late, 20.0, 1));
  ASSERT_NE(found.of(1), nullptr);
  EXPECT_TRUE(found.of(1)->has_clock);
  EXPECT_FALSE(found.of(1)->has_orientation);
  EXPECT_EQ(found.of(1)->orientation, Vector(Vector::Zero()));
  found = corrections();
  found.decide(aligned(turned, 20.0, 1));
  ASSERT_NE(found.of(1), nullptr);
  EXPECT_FALSE(found.of(1)->has_clock);
  EXPECT_TRUE(found.of(1)->has_orientation);
}

TEST(StationCorrections, OfTwoStationsNobodyCanTellWhichIsOff) {
  std::vector<Fault> faults(2);
  faults[1] = {0.05, {0.002, -0.003, 0.003}};
  StationCorrections found = corrections();
  EXPECT_FALSE(found.decide(aligned(faults, 20.0, 1)));
  EXPECT_EQ(found.of(0), nullptr);
  EXPECT_EQ(found.of(1), nullptr);
  EXPECT_EQ(found.undecided(), (std::vector<int>{0, 1}));
}

TEST(StationCorrections, AStationThatIsPutRightIsTakenAsItSaysAgain) {
  StationAlignmentParams params;
  params.memory = 20.0;
  StationAlignment alignment(params);
  RandomStream random(3);
  std::vector<Fault> faults(4);
  faults[2].clock = 0.05;
  look(alignment, faults, 0.0, 20.0, random);
  StationCorrections found({}, params);
  EXPECT_TRUE(found.decide(alignment));
  EXPECT_FALSE(found.decide(alignment)) << "nothing new";
  ASSERT_NE(found.of(2), nullptr);
  for (double t = 20.0; t < 220.0; t += 10.0) {
    alignment.forget(10.0);
    look(alignment, std::vector<Fault>(4), t, t + 10.0, random);
    found.decide(alignment);
  }
  EXPECT_EQ(found.of(2), nullptr);
}

TEST(StationCorrections, ACorrectedRayPointsAtTheTargetAndSaysWhatIsNotKnown) {
  const Vector turned(-0.002, 0.003, -0.003);
  const Target now = targetAt(0, 3.0), before = targetAt(0, 2.95);
  const Ray right = rayOf(kOrigins[1], now), seen = rayOf(kOrigins[1], before, turned);
  StationCorrection correction;
  correction.has_clock = correction.has_orientation = true;
  correction.clock = 0.05;
  correction.orientation = turned;
  const Ray exact = corrected(seen, correction);
  EXPECT_GT((seen.direction - right.direction).norm(), 2e-3);
  EXPECT_LT((exact.direction - right.direction).norm(), 1e-4);  // curvature and squares of the angles
  EXPECT_NEAR(exact.direction.norm(), 1.0, 1e-12);
  correction.covariance.diagonal() << 1e-4, 1e-6, 1e-6, 1e-6;
  const double clock_part = 1e-4 * seen.motion->rate.squaredNorm();
  EXPECT_NEAR(corrected(seen, correction).covariance.trace() - exact.covariance.trace(), 2e-6 + clock_part,
              1e-8);
}

TEST(StationCorrections, ParametersOutOfRangeAreRefused) {
  StationCorrectionParams params;
  params.normal_clock_sigma = 1.0;  // above that of a clock that is wrong
  EXPECT_THROW(StationCorrections(params, {}), std::invalid_argument);
  params = {};
  params.release = params.significance;
  EXPECT_THROW(StationCorrections(params, {}), std::invalid_argument);
  params = {};
  params.normal_orientation_sigma = 0.0;
  EXPECT_THROW(StationCorrections(params, {}), std::invalid_argument);
}

TEST(StationCorrections, NothingIsCorrectedWhereItIsNotWanted) {
  std::vector<Fault> faults(4);
  faults[2].clock = 0.05;
  StationCorrectionParams params;
  params.enabled = false;
  StationCorrections found(params, {});
  EXPECT_FALSE(found.decide(aligned(faults, 20.0, 1)));
  EXPECT_EQ(found.of(2), nullptr);
}

}  // namespace
}  // namespace sightline::core
