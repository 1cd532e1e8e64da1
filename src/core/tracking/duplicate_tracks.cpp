#include "sightline/core/tracking/duplicate_tracks.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include <Eigen/Cholesky>

namespace sightline::core {
namespace {

constexpr double kSameMotion = 18.5;  // 99.9 % of chi^2 with four degrees of freedom
constexpr std::size_t kMostPairs = 10000;

/// Squared distance of two predictions in units of both their covariances.
double distanceSquared(const TrackPrediction& a, const TrackPrediction& b) {
  const AngularState there = a.chart.fromTracking(b.chart.toTracking(b.state));
  Eigen::Vector4d difference = there.mean - a.state.mean;
  difference.head<2>() = angleDifference(there.angles(), a.state.angles());
  const Eigen::LLT<Eigen::Matrix4d> both(a.state.covariance + there.covariance);
  if (both.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return difference.dot(both.solve(difference));
}

/// Whether two predictions are so far apart that nothing need be computed.
bool areFarApart(const TrackPrediction& a, const TrackPrediction& b) {
  // In a chart the azimuth's variance is at least that on the sphere: the chord is within the sum of both.
  const double variance = a.state.anglesCovariance().trace() + b.state.anglesCovariance().trace();
  return (a.direction - b.direction).squaredNorm() > kSameMotion * variance;
}

}  // namespace

// (S-44)
std::vector<std::uint32_t> DuplicateTracks::watch(const std::vector<TrackPrediction>& predictions,
                                                  const AssociationResult& result, int scans) {
  std::vector<Pair> together;
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    if (!predictions[i].believed) continue;
    for (std::size_t k = i + 1; k < predictions.size(); ++k) {
      if (!predictions[k].believed || areFarApart(predictions[i], predictions[k])) continue;
      const bool is_seen = result.sighting_of[i] >= 0, is_other_seen = result.sighting_of[k] >= 0;
      if ((is_seen && is_other_seen) || together.size() >= kMostPairs) continue;
      if (distanceSquared(predictions[i], predictions[k]) > kSameMotion) continue;
      Pair pair{std::min(predictions[i].id, predictions[k].id),
                std::max(predictions[i].id, predictions[k].id), is_seen || is_other_seen ? 1 : 0};
      together.push_back(pair);
    }
  }
  const auto byIds = [](const Pair& a, const Pair& b) {
    return std::tie(a.older, a.younger) < std::tie(b.older, b.younger);
  };
  std::sort(together.begin(), together.end(), byIds);
  std::vector<std::uint32_t> duplicates;
  for (Pair& pair : together) {
    const auto before = std::lower_bound(pairs_.begin(), pairs_.end(), pair, byIds);
    if (before != pairs_.end() && !byIds(pair, *before)) pair.scans += before->scans;
    if (pair.scans >= scans) duplicates.push_back(pair.younger);
  }
  pairs_ = std::move(together);
  std::sort(duplicates.begin(), duplicates.end());
  duplicates.erase(std::unique(duplicates.begin(), duplicates.end()), duplicates.end());
  return duplicates;
}

}  // namespace sightline::core
