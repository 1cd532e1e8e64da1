#include "sightline/core/association.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "sightline/core/assignment.h"

namespace sightline::core {
namespace {

/// A sighting in the gate of a track.
struct Candidate {
  int expectation = 0;
  int sighting = 0;
  Association pair;  // as it would be recorded
  double cost = 0.0;
};

/// Whether a sighting is so far away that no gate computation is needed: its chord to the prediction is
/// longer than the largest half width that S can have. In a chart the azimuth's variance is at most
/// 1/cos^2(80 deg) = 33 times that on the sphere.
bool isFarAway(const Expectation& expectation, const Eigen::Vector3d& predicted, const Sighting& sighting,
               double noise_scale, const GateParams& params, double threshold) {
  const double largest_noise = std::max(expectation.noise_scale.maxCoeff(), 1.0 / noise_scale);
  const double largest_variance =
      expectation.innovation_scale *
      (expectation.prediction.anglesCovariance().trace() + expectation.smear.trace() +
       34.0 * std::max(largest_noise, 1.0) * sighting.covariance.trace());
  const double reach = threshold * largest_variance + 2.0 * params.min_half_width * params.min_half_width;
  return (sighting.direction - predicted).squaredNorm() > reach;
}

/// The pair by one covariance of the sighting's noise; `is_inside`: whether it is within the gate.
Association compare(const Expectation& expectation, const Sighting& sighting, const Eigen::Matrix2d& noise,
                    const GateParams& params, double threshold, bool& is_inside) {
  const Gate gate = gateOf(expectation.prediction, noise, params, expectation.innovation_scale);
  Association pair;
  pair.track = expectation.id;
  pair.innovation = angleDifference(expectation.chart.coordinatesOf(sighting.direction), gate.centre);
  pair.covariance = gate.covariance;
  pair.distance_squared = distanceSquared(gate, pair.innovation);
  pair.threshold = threshold;
  is_inside = isInside(gate, pair.innovation, params);
  return pair;
}

/// The pair by the noise that has been found; where that is less than stated, and the sighting is outside, by
/// the stated one: now and then a sensor that is calmer than it says is only as accurate as it says.
Association comparison(const Expectation& expectation, const Sighting& sighting, double noise_scale,
                       const GateParams& params, double threshold, bool& is_inside) {
  const Association found =
      compare(expectation, sighting, expectation.noiseOf(sighting), params, threshold, is_inside);
  const Eigen::Vector2d stated = expectation.noise_scale.cwiseMax(std::max(1.0 / noise_scale, 1.0));
  if (is_inside || stated == expectation.noise_scale) return found;
  return compare(expectation, sighting,
                 noiseCovariance(expectation.chart.covarianceOf(sighting), stated) + expectation.smear,
                 params, threshold, is_inside);
}

/// All pairs inside a gate; `decisions` keeps for each sighting the nearest track, in its gate or not.
std::vector<Candidate> candidatesOf(const Scan& scan, const std::vector<Expectation>& expectations,
                                    const GateParams& params, std::vector<Association>& decisions) {
  const double threshold = gateThreshold(params);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < expectations.size(); ++i) {
    const Expectation& expectation = expectations[i];
    const Eigen::Vector3d predicted = expectation.chart.directionAt(expectation.prediction.angles());
    for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
      const Sighting& sighting = scan.sightings[j];
      if (isFarAway(expectation, predicted, sighting, scan.noise_scale, params, threshold)) continue;
      bool is_inside = false;
      Association pair = comparison(expectation, sighting, scan.noise_scale, params, threshold, is_inside);
      pair.sighting = static_cast<std::uint32_t>(j);
      if (!(decisions[j].distance_squared <= pair.distance_squared)) decisions[j] = pair;
      if (!is_inside) continue;
      const double cost = pair.distance_squared + std::log(pair.covariance.determinant());
      candidates.push_back({static_cast<int>(i), static_cast<int>(j), std::move(pair), cost});
    }
  }
  return candidates;
}

/// Index of each value within the sorted list of those that occur.
std::vector<int> occurring(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

int indexIn(const std::vector<int>& sorted, int value) {
  return static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

/// One round of optimal assignment among the given candidates.
void assignRound(const std::vector<const Candidate*>& candidates, Pairing& pairing) {
  std::vector<int> tracks, sightings;
  for (const Candidate* candidate : candidates) {
    tracks.push_back(candidate->expectation);
    sightings.push_back(candidate->sighting);
  }
  tracks = occurring(std::move(tracks));
  sightings = occurring(std::move(sightings));

  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(tracks.size()),
                                                   static_cast<Eigen::Index>(sightings.size()),
                                                   std::numeric_limits<double>::infinity());
  for (const Candidate* candidate : candidates) {
    cost(indexIn(tracks, candidate->expectation), indexIn(sightings, candidate->sighting)) = candidate->cost;
  }
  const std::vector<int> columns = assign(cost);
  for (std::size_t row = 0; row < columns.size(); ++row) {
    if (columns[row] < 0) continue;
    const int sighting = sightings[static_cast<std::size_t>(columns[row])];
    pairing.sighting_of[static_cast<std::size_t>(tracks[row])] = sighting;
    pairing.expectation_of[static_cast<std::size_t>(sighting)] = tracks[row];
  }
}

}  // namespace

Pairing associate(const Scan& scan, const std::vector<Expectation>& expectations, const GateParams& params) {
  Pairing pairing;
  pairing.sighting_of.assign(expectations.size(), -1);
  pairing.expectation_of.assign(scan.sightings.size(), -1);
  pairing.may_start.assign(scan.sightings.size(), true);
  pairing.decisions.resize(scan.sightings.size());
  for (std::size_t j = 0; j < scan.sightings.size(); ++j)
    pairing.decisions[j].sighting = static_cast<std::uint32_t>(j);

  const std::vector<Candidate> candidates = candidatesOf(scan, expectations, params, pairing.decisions);
  for (const bool believed : {true, false}) {
    std::vector<const Candidate*> round;
    for (const Candidate& candidate : candidates) {
      const bool is_free = pairing.expectation_of[static_cast<std::size_t>(candidate.sighting)] < 0;
      if (is_free && expectations[static_cast<std::size_t>(candidate.expectation)].believed == believed)
        round.push_back(&candidate);
    }
    assignRound(round, pairing);
  }

  for (const Candidate& candidate : candidates) {
    const auto j = static_cast<std::size_t>(candidate.sighting);
    const Expectation& expectation = expectations[static_cast<std::size_t>(candidate.expectation)];
    if (pairing.expectation_of[j] == candidate.expectation) {
      pairing.decisions[j] = candidate.pair;
      pairing.decisions[j].decision = Decision::accepted;
      pairing.may_start[j] = false;
    } else if (pairing.expectation_of[j] < 0 && expectation.guards && pairing.may_start[j]) {
      pairing.decisions[j] = candidate.pair;
      pairing.decisions[j].decision = Decision::claimed_by_other;
      pairing.may_start[j] = false;
    }
  }
  return pairing;
}

}  // namespace sightline::core
