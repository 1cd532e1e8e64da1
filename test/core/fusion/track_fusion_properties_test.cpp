// What holds for every rule of the track fusion, and how honest each is.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/estimators/kalman.h"
#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/model/sphere.h"

#include "../../bench/fusion_benchmark.h"
#include "support/covariances.h"
#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector4d;
using test::at;
using test::localTrack;
using test::reportOf;

/// Reports of `count` trackers on one target, each at its own times, that wander round the truth as filters
/// do.
std::vector<LocalReport> reportsAbout(const Vector2d& angles, double sigma, std::uint64_t seed,
                                      int count = 4) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<LocalReport> reports;
  for (int k = 0; k < 60; ++k) {
    const double t = 10.0 + 0.01 * k;
    const int tracker = k % count;
    Track track = localTrack(1, angles, sigma * (1.0 + 0.5 * tracker));
    const Matrix4d root = Eigen::LLT<Matrix4d>(track.state.covariance).matrixL();
    track.state.mean += 0.5 * root * Vector4d(normal(random), normal(random), normal(random), normal(random));
    reports.push_back(reportOf(std::string(1, static_cast<char>('a' + tracker)), t, {track}));
  }
  return reports;
}

FusionReport fuseAll(const TrackFusionParams& params, const std::vector<LocalReport>& reports) {
  TrackFusion fusion(params);
  FusionReport result;
  for (const LocalReport& report : reports) result = fusion.onReport(report);
  return result;
}

/// Largest difference of two states, in units of `b`'s standard deviations.
double disagreement(const AngularState& a, const AngularState& b) {
  const Vector4d sigma = b.covariance.diagonal().cwiseSqrt();
  Vector4d mean = a.mean - b.mean;
  mean(0) = wrapAngle(mean(0));
  const Matrix4d covariance =
      sigma.cwiseInverse().asDiagonal() * (a.covariance - b.covariance) * sigma.cwiseInverse().asDiagonal();
  return std::max(mean.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), covariance.cwiseAbs().maxCoeff());
}

void forEveryRule(const std::function<void(const TrackFusionParams&)>& property) {
  for (const FusionRule rule :
       {FusionRule::weighted_covariance, FusionRule::cross_covariance, FusionRule::covariance_intersection}) {
    for (const auto weights : {IntersectionWeights::determinant, IntersectionWeights::trace}) {
      if (rule != FusionRule::covariance_intersection && weights == IntersectionWeights::trace) continue;
      SCOPED_TRACE(nameOf(rule) + (weights == IntersectionWeights::trace ? ", trace" : ""));
      TrackFusionParams params;
      params.rule = rule;
      params.intersection_weights = weights;
      property(params);
    }
  }
}

/// The one fused state of these reports.
AngularState fusedState(const TrackFusionParams& params, const std::vector<LocalReport>& reports) {
  const FusionReport result = fuseAll(params, reports);
  EXPECT_EQ(result.tracks.size(), 1u);
  EXPECT_EQ(result.tracks.at(0).sources.size(), 4u);
  return result.tracks.at(0).track.state;
}

TEST(TrackFusionProperties, FusedCovarianceIsNeverLargerThanTheBestSource) {
  // All report at one instant, so that the sources are those of the last reports as they are.
  forEveryRule([](const TrackFusionParams& params) {
    std::vector<LocalReport> reports = reportsAbout({0.3, 0.2}, 1e-3, 1);
    std::vector<Matrix4d> covariances;
    for (std::size_t i = reports.size() - 4; i < reports.size(); ++i) {
      reports[i] = reportOf(reports[i].tracker, 11.0, reports[i].tracks);
      covariances.push_back(reports[i].tracks[0].state.covariance);
    }
    const Matrix4d fused = fusedState(params, reports).covariance;
    double least_volume = std::numeric_limits<double>::infinity(), harmonic = 0.0;
    for (const Matrix4d& P : covariances) {
      least_volume = std::min(least_volume, std::log(P.determinant() * 1e24));
      harmonic += 1.0 / P.trace() / 4.0;
      if (params.rule == FusionRule::covariance_intersection) continue;
      const double margin = test::leastEigenvalue((P - fused) / P.norm());
      EXPECT_GE(margin, -1e-9) << "Loewner order";
    }
    if (params.rule != FusionRule::covariance_intersection) return;
    if (params.intersection_weights == IntersectionWeights::determinant) {
      EXPECT_LE(std::log(fused.determinant() * 1e24), least_volume + 1e-6);
    } else {
      EXPECT_LE(fused.trace(), (1.0 + 1e-9) / harmonic);
    }
  });
}

TEST(TrackFusionProperties, NamesAndOrderOfSourcesDoNotMatter) {
  forEveryRule([](const TrackFusionParams& params) {
    std::vector<LocalReport> reports = reportsAbout({0.3, 0.2}, 1e-3, 2);
    for (LocalReport& report : reports) {  // four at a time at the same instant
      report =
          reportOf(report.tracker, 10.0 + 0.04 * std::floor((seconds(report.time - at(10.0)) + 1e-6) / 0.04),
                   report.tracks);
    }
    std::vector<LocalReport> turned = reports;
    for (std::size_t i = 0; i + 3 < turned.size(); i += 4) {
      std::reverse(turned.begin() + static_cast<std::ptrdiff_t>(i),
                   turned.begin() + static_cast<std::ptrdiff_t>(i) + 4);
    }
    for (LocalReport& report : turned) report.tracker[0] = static_cast<char>('z' - (report.tracker[0] - 'a'));
    EXPECT_LT(disagreement(fusedState(params, turned), fusedState(params, reports)), 1e-6);
  });
}

TEST(TrackFusionProperties, YawOfTheFrameDoesNotMatter) {
  forEveryRule([](const TrackFusionParams& params) {
    for (const double elevation : {0.2, 1.2, 1.55}) {
      const std::vector<LocalReport> reports = reportsAbout({0.3, elevation}, 1e-4, 3);
      const AngularState plain = fusedState(params, reports);
      for (const double yaw : {1.0, kPi - 0.3, -3.0, kPi - 0.30005}) {
        std::vector<LocalReport> turned = reports;
        for (LocalReport& report : turned) {
          double& azimuth = report.tracks[0].state.mean(0);
          azimuth = wrapAngle(azimuth + yaw);
        }
        AngularState expected = plain;
        expected.mean(0) += yaw;
        EXPECT_LT(disagreement(fusedState(params, turned), expected), 1e-7) << elevation << " " << yaw;
      }
    }
  });
}

TEST(TrackFusionProperties, TimeShiftDoesNotMatterAtAll) {
  forEveryRule([](const TrackFusionParams& params) {
    const std::vector<LocalReport> reports = reportsAbout({0.3, 0.2}, 1e-3, 4);
    std::vector<LocalReport> shifted = reports;
    for (LocalReport& report : shifted) {
      report.time += std::chrono::hours(24 * 365 * 50);
      report.tracks[0].last_sighting = report.time;
    }
    const AngularState a = fusedState(params, shifted), b = fusedState(params, reports);
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.covariance, b.covariance);
  });
}

TEST(TrackFusionProperties, ScaleDoesNotMatter) {
  forEveryRule([](const TrackFusionParams& params) {
    const AngularState unit = fusedState(params, reportsAbout({0.0, 0.0}, 1e-2, 5));
    for (const double scale : {1e-3, 1e-1, 10.0}) {  // sigmas from 10 microradian to 0.1 rad and more
      const AngularState scaled = fusedState(params, reportsAbout({0.0, 0.0}, 1e-2 * scale, 5));
      const AngularState expected{scale * unit.mean, scale * scale * unit.covariance};
      EXPECT_LT(disagreement(scaled, expected), 1e-6) << scale;
    }
  });
}

TEST(TrackFusionProperties, PlaceOnTheSphereDoesNotMatter) {
  // The same wandering about another direction, turned there on the sphere: near the zenith as at the
  // horizon.
  forEveryRule([](const TrackFusionParams& params) {
    const std::vector<LocalReport> reports = reportsAbout({0.0, 0.0}, 1e-5, 6);
    const AngularState plain = fusedState(params, reports);
    for (const double tilt : {0.5, 1.3, 1.5707}) {
      const Eigen::Matrix3d R = Eigen::AngleAxisd(-tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
      std::vector<LocalReport> turned = reports;
      for (LocalReport& report : turned) report.tracks[0].state = rotateState(report.tracks[0].state, R);
      const AngularState back = rotateState(fusedState(params, turned), R.transpose());
      EXPECT_LT(disagreement(back, plain), 1e-3) << tilt;  // the curvature of sigma = 10 microradian
    }
  });
}

// ---- consistency: figures of the reference (E5), for Kalman filters on the paper's benchmark
// ----------------------

std::unique_ptr<Estimator> kalman() {
  KalmanParams params;
  params.process_noise = bench::kDensity * bench::kAmplitude * bench::kAmplitude;
  return std::make_unique<KalmanEstimator>(params);
}

std::vector<TrackFusionParams> paperAndCross() {
  std::vector<TrackFusionParams> fusions(2);
  fusions[0].rule = FusionRule::weighted_covariance;
  fusions[1].rule = FusionRule::cross_covariance;
  return fusions;
}

/// Both this mean over some runs and the reference's over 100 are moved by chance; five times that.
void expectReference(const bench::Figure& figure, double runs, double reference, const char* what) {
  const double error = figure.standardError() * std::sqrt(1.0 + runs / 100.0);
  EXPECT_NEAR(figure.mean(), reference, 5.0 * error) << what;
  EXPECT_LT(5.0 * error, 0.25 * reference) << what << ": too few runs to tell anything";
}

constexpr int kRuns = 20;

void expectReference(const bench::FusionScore& score, double rmse, double position_nees, double state_nees) {
  expectReference(score.squares, kRuns, std::pow(0.08 * rmse, 2), "squared error");
  expectReference(score.position_nees, kRuns, position_nees, "ANEES of the position");
  expectReference(score.state_nees, kRuns, state_nees, "ANEES of the state");
}

TEST(TrackFusionConsistency, TwoEqualSensorsAgreeWithTheReference) {
  const auto scores =
      bench::score({bench::Target::sinusoid, {0.08, 0.08}, kalman, true, kRuns, 1}, paperAndCross());
  EXPECT_EQ(scores.broken, 0u);
  expectReference(scores.fused[0], 0.354, 1.08, 0.86);
  expectReference(scores.fused[1], 0.354, 0.89, 0.63);
}

TEST(TrackFusionConsistency, SixSensorsAgreeWithTheReference) {
  const auto scores =
      bench::score({bench::Target::sinusoid, {0.08, 0.08, 0.08, 0.15, 0.15, 0.15}, kalman, true, kRuns, 1},
                   paperAndCross());
  EXPECT_EQ(scores.broken, 0u);
  expectReference(scores.fused[0], 0.318, 1.82, 1.75);
  expectReference(scores.fused[1], 0.307, 0.92, 0.60);
}

TEST(TrackFusionConsistency, CrossCovarianceIsHonestAndWeightedCovarianceIsNotForManoeuvresSharedByAll) {
  // The target obeys the local filters' model, so that 1 is right. Each sensor sights at its own times.
  const auto scores = bench::score(
      {bench::Target::white_acceleration, {0.08, 0.08, 0.08, 0.15, 0.15, 0.15}, kalman, false, kRuns, 1},
      paperAndCross());
  EXPECT_EQ(scores.broken, 0u);
  const bench::FusionScore &weighted = scores.fused[0], &cross = scores.fused[1];
  EXPECT_NEAR(scores.local.state_nees.mean(), 1.0, 5.0 * scores.local.state_nees.standardError());
  EXPECT_NEAR(cross.position_nees.mean(), 1.0, 5.0 * cross.position_nees.standardError());
  EXPECT_NEAR(cross.state_nees.mean(), 1.0, 5.0 * cross.state_nees.standardError());
  EXPECT_GT(weighted.position_nees.mean(), 1.5);
  EXPECT_GT(weighted.state_nees.mean(), 2.5);
  EXPECT_LT(cross.rmse(), weighted.rmse());
}

TEST(TrackFusionConsistency, WeightedCovarianceIsHonestForIndependentErrors) {
  // A straight line, sighted by filters without process noise: nothing is shared.
  const auto straight = [] {
    KalmanParams params;
    params.process_noise = 1e-30;
    return std::make_unique<KalmanEstimator>(params);
  };
  std::mt19937_64 random(1);
  bench::Figure nees;
  for (int run = 0; run < 200; ++run) {
    std::vector<bench::LocalSource> sources;
    for (std::size_t i = 0; i < 4; ++i) sources.emplace_back(i, 0.1, straight);
    TrackFusion fusion(paperAndCross()[0]);
    FusionReport report;
    const Vector4d start(0.2, -0.1, 0.3, 0.1);
    for (int k = 0; k < 30; ++k) {
      Vector4d truth = start;
      truth.head<2>() += 0.03 * k * start.tail<2>();
      for (bench::LocalSource& source : sources)
        report = fusion.onReport(source.sight(at(1.0 + 0.03 * k), truth, random));
      if (k < 29) continue;
      ASSERT_EQ(report.tracks.size(), 1u);
      ASSERT_EQ(report.tracks[0].sources.size(), 4u);
      const AngularState& fused = report.tracks[0].track.state;
      const Vector4d error = fused.mean - bench::kAmplitude * truth;
      nees.add(error.dot(fused.covariance.llt().solve(error)) / 4.0);
      nees.endRun();
    }
  }
  EXPECT_NEAR(nees.mean(), 1.0, 5.0 * nees.standardError());
  EXPECT_LT(5.0 * nees.standardError(), 0.3);
}

}  // namespace
}  // namespace sightline::core
