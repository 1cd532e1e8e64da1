#include "sightline/core/association/association.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/LU>

#include "sightline/core/association/assignment.h"
#include "sightline/core/association/clusters.h"
#include "sightline/core/association/joint_association.h"
#include "sightline/core/estimators/rate_prior.h"

namespace sightline::core {
namespace {

constexpr double kTwoPi = 6.28318530717958648;
constexpr double kLeastMissed = 1e-12;       // probability: nothing is for certain
constexpr double kLeastCosine = 0.1;         // of an elevation in a chart
constexpr double kLeastGainOfBranch = -5.0;  // ln of how much less likely than a miss a second look may be
constexpr double kChanges = 0.1;             // of young targets, those that change their rates at each look
constexpr double kLeastVisibility = 0.01;    // of a target that has been sighted: it may be seen after all
constexpr double kMostLogRatio = 40.0;       // what is beyond is as certain as can be

/// The sightings in the gates of the tracks.
struct Candidates {
  std::vector<GatedPair> pairs;     // `track` is the place among the predictions
  std::vector<Association> record;  // for each, as it would be recorded
  std::vector<GatedPair> changed;   // outside, but possible where the target has changed its rates
  std::vector<Association> record_of_changed;
  std::vector<GatedPair> unlikely;  // of targets seen once: less likely than that they were missed
};

/// Probability that the scan shows the target of a track, where one of its sightings may be that.
double detection(const TrackPrediction& prediction) {  // (S-39)
  return std::max(prediction.visibility, kLeastVisibility) * prediction.detection_probability;
}

/// ln(v P_D N(innovation; 0, S) / clutter density). The chart's coordinates shrink with the cosine of its
/// elevation: what is per rad^2 there is 1 / cos of that per sr.
// (S-31)
double logRatio(const TrackPrediction& prediction, const Association& pair, double clutter_density) {
  const Eigen::Matrix2d& S = pair.covariance;
  const double determinant = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  const double area =
      kTwoPi * std::sqrt(determinant) * std::max(std::cos(prediction.state.angles().y()), kLeastCosine);
  return std::log(detection(prediction) / (area * clutter_density)) - 0.5 * pair.distance_squared;
}

/// Whether a sighting is so far away that no gate computation is needed: its chord to the prediction is
/// longer than the largest half width that S can have. In a chart the azimuth's variance is at most
/// 1/cos^2(80 deg) = 33 times that on the sphere.
bool isFarAway(const TrackPrediction& prediction, const Sighting& sighting, double noise_scale,
               const GateParams& params, double threshold) {
  const double largest_noise = std::max(prediction.noise_scale.maxCoeff(), 1.0 / noise_scale);
  const double largest_variance =
      prediction.innovation_scale *
      (prediction.state.anglesCovariance().trace() + prediction.stamp_covariance.trace() +
       34.0 * std::max(largest_noise, 1.0) * sighting.covariance.trace());
  const double change_variance = prediction.change_sigma * prediction.change_sigma;
  const double reach = threshold * (largest_variance + 2.0 * change_variance) +
                       2.0 * params.min_half_width * params.min_half_width;
  return (sighting.direction - prediction.direction).squaredNorm() > reach;
}

/// The pair by one covariance of the sighting's noise; `is_inside`: whether it is within the gate.
Association compare(const TrackPrediction& prediction, const Sighting& sighting, const Eigen::Matrix2d& noise,
                    const GateParams& params, double threshold, bool& is_inside) {
  const Gate gate = gateOf(prediction.state, noise, params, prediction.innovation_scale);
  Association pair;
  pair.track = prediction.id;
  pair.innovation = angleDifference(prediction.chart.coordinatesOf(sighting.direction), gate.centre);
  pair.covariance = gate.covariance;
  pair.distance_squared = distanceSquared(gate, pair.innovation);
  pair.threshold = threshold;
  is_inside = isInside(gate, pair.innovation, params);
  return pair;
}

/// The pair by the noise that has been found; where that is less than stated, and the sighting is outside, by
/// the stated one: now and then a sensor that is calmer than it says is only as accurate as it says.
Association comparison(const TrackPrediction& prediction, const Sighting& sighting, double noise_scale,
                       const GateParams& params, double threshold, bool& is_inside) {
  const Association found =
      compare(prediction, sighting, prediction.noiseOf(sighting), params, threshold, is_inside);
  const Eigen::Vector2d stated = prediction.noise_scale.cwiseMax(std::max(1.0 / noise_scale, 1.0));
  if (is_inside || stated == prediction.noise_scale) return found;
  return compare(
      prediction, sighting,
      noiseCovariance(prediction.chart.covarianceOf(sighting), stated) + prediction.stamp_covariance, params,
      threshold, is_inside);
}

double missWeight(const TrackPrediction& prediction) {  // (S-39)
  return 1.0 - prediction.visibility * prediction.detection_probability;
}

/// The second look at a target: its rates are not known. What counts is the density of the mixture of all
/// that they may be; the gate is where a pair is more likely than a miss and a false sighting, or not much
/// less.
// (S-92), (S-93)
class SecondLook {
 public:
  SecondLook(const TrackPrediction& prediction, const Scan& scan, const GateParams& params,
             double clutter_density, bool with_branches)
      : prediction_(prediction) {
    const double area_scale = std::max(std::cos(prediction.state.angles().y()), kLeastCosine);
    log_clutter_ = std::log(clutter_density * area_scale);
    least_ = log_clutter_ + std::log(missWeight(prediction) / detection(prediction)) +
             (with_branches ? kLeastGainOfBranch : 0.0);
    double largest_noise = 0.0;
    for (const Sighting& sighting : scan.sightings)
      largest_noise = std::max(largest_noise, sighting.covariance.trace());
    const double farthest = rate_prior::reach(least_, prediction.only_sighting, 34.0 * largest_noise,
                                              prediction.since_only_sighting);
    reach_ = std::min(farthest, params.max_half_width);
  }

  /// The pair, if the sighting is in the gate.
  std::optional<Association> pairWith(const Sighting& sighting, double& log_ratio) const {
    if ((sighting.direction - prediction_.direction).squaredNorm() > reach_ * reach_) return std::nullopt;
    const double h = prediction_.since_only_sighting;
    const Eigen::Matrix2d R = prediction_.only_sighting + prediction_.noiseOf(sighting);
    Association pair;
    pair.track = prediction_.id;
    pair.innovation =
        angleDifference(prediction_.chart.coordinatesOf(sighting.direction), prediction_.state.angles());
    const double log_density = rate_prior::logDensityOfOffset(pair.innovation, R, h);
    if (!(log_density > least_)) return std::nullopt;
    log_ratio = std::log(detection(prediction_)) + log_density - log_clutter_;
    const double spread = rate_prior::sigma(pair.innovation, R, h) * h;
    Gate gate;
    gate.covariance = R + spread * spread * Eigen::Matrix2d::Identity();
    pair.covariance = gate.covariance;
    pair.distance_squared = distanceSquared(gate, pair.innovation);
    return pair;
  }

 private:
  const TrackPrediction& prediction_;
  double log_clutter_ = 0.0;  // of false sightings in the chart [1/rad^2]
  double least_ = 0.0;        // least density of a pair [ln 1/rad^2]
  double reach_ = 0.0;        // chord beyond which it is less [1]
};

/// Goes over to the gate of a tentative track whose target has changed its rates since the last look, (S-94);
/// false where that does not reach as far.
bool widen(Association& pair, const TrackPrediction& prediction, const GateParams& params) {
  if (!(prediction.change_sigma > 0.0)) return false;
  Gate gate;
  gate.covariance = pair.covariance;
  gate.covariance.diagonal().array() += prediction.change_sigma * prediction.change_sigma;
  pair.covariance = gate.covariance;
  pair.distance_squared = distanceSquared(gate, pair.innovation);
  return pair.distance_squared <= pair.threshold && pair.innovation.norm() <= params.max_half_width;
}

/// The pairs of a track whose target has been seen once.
void addSecondLooks(const Scan& scan, int track, const TrackPrediction& prediction, const GateParams& params,
                    double clutter_density, bool with_branches, std::vector<Association>& decisions,
                    Candidates& candidates) {
  const SecondLook look(prediction, scan, params, clutter_density, with_branches);
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    double log_ratio = 0.0;
    std::optional<Association> pair = look.pairWith(scan.sightings[j], log_ratio);
    if (!pair || !std::isfinite(log_ratio)) continue;
    pair->sighting = static_cast<std::uint32_t>(j);
    pair->threshold = gateThreshold(params);
    if (log_ratio <= std::log(missWeight(prediction))) {
      candidates.unlikely.push_back({track, static_cast<int>(j), log_ratio});
      continue;
    }
    if (!(decisions[j].distance_squared <= pair->distance_squared)) decisions[j] = *pair;
    candidates.pairs.push_back({track, static_cast<int>(j), log_ratio});
    candidates.record.push_back(*std::move(pair));
  }
}

/// All pairs inside a gate; `decisions` keeps for each sighting the nearest track, in its gate or not.
Candidates candidatesOf(const Scan& scan, const std::vector<TrackPrediction>& predictions,
                        const GateParams& params, double clutter_density, bool with_branches,
                        std::vector<Association>& decisions) {
  const double threshold = gateThreshold(params);
  Candidates candidates;
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    const TrackPrediction& prediction = predictions[i];
    if (prediction.since_only_sighting > 0.0) {
      addSecondLooks(scan, static_cast<int>(i), prediction, params, clutter_density, with_branches, decisions,
                     candidates);
      continue;
    }
    for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
      const Sighting& sighting = scan.sightings[j];
      if (isFarAway(prediction, sighting, scan.noise_scale, params, threshold)) continue;
      bool is_inside = false;
      Association pair = comparison(prediction, sighting, scan.noise_scale, params, threshold, is_inside);
      pair.sighting = static_cast<std::uint32_t>(j);
      if (!(decisions[j].distance_squared <= pair.distance_squared)) decisions[j] = pair;
      if (is_inside) {
        const double log_ratio = logRatio(prediction, pair, clutter_density);
        if (!std::isfinite(log_ratio)) continue;  // a hypothesis without a density is a miss
        candidates.pairs.push_back({static_cast<int>(i), static_cast<int>(j), log_ratio});
        candidates.record.push_back(std::move(pair));
      } else if (widen(pair, prediction, params)) {
        const double log_ratio = std::log(kChanges) + logRatio(prediction, pair, clutter_density);
        if (!std::isfinite(log_ratio)) continue;
        candidates.changed.push_back({static_cast<int>(i), static_cast<int>(j), log_ratio});
        candidates.record_of_changed.push_back(std::move(pair));
      }
    }
  }
  return candidates;
}

void take(const GatedPair& pair, const std::vector<TrackPrediction>& predictions,
          AssociationResult& pairing) {
  const auto i = static_cast<std::size_t>(pair.track);
  pairing.sighting_of[i] = pair.sighting;
  pairing.prediction_of[static_cast<std::size_t>(pair.sighting)] = pair.track;
  pairing.evidence[i] = missWeight(predictions[i]) + std::exp(std::min(pair.log_ratio, kMostLogRatio));
}

/// The best assignment within one cluster.
void assignCluster(const std::vector<GatedPair>& pairs, const std::vector<int>& cluster,
                   const std::vector<TrackPrediction>& predictions, AssociationResult& pairing) {  // (S-32)
  const auto gain = [&](const GatedPair& pair) {  // over a miss
    return pair.log_ratio - std::log(missWeight(predictions[static_cast<std::size_t>(pair.track)]));
  };
  if (cluster.size() == 1) {
    const GatedPair& pair = pairs[static_cast<std::size_t>(cluster.front())];
    if (gain(pair) > 0.0) take(pair, predictions, pairing);
    return;
  }
  std::vector<int> tracks, sightings;
  for (const int k : cluster) {
    tracks.push_back(pairs[static_cast<std::size_t>(k)].track);
    sightings.push_back(pairs[static_cast<std::size_t>(k)].sighting);
  }
  tracks = occurring(std::move(tracks));
  sightings = occurring(std::move(sightings));
  const auto rows = static_cast<Eigen::Index>(tracks.size());
  const auto columns = static_cast<Eigen::Index>(sightings.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(rows, columns, std::numeric_limits<double>::infinity());
  Eigen::MatrixXi index = Eigen::MatrixXi::Constant(rows, columns, -1);
  for (const int k : cluster) {
    const GatedPair& pair = pairs[static_cast<std::size_t>(k)];
    const Eigen::Index row = indexIn(tracks, pair.track), column = indexIn(sightings, pair.sighting);
    cost(row, column) = -gain(pair);
    index(row, column) = k;
  }
  const std::vector<int> chosen = assign(cost, 0.0);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const int column = chosen[static_cast<std::size_t>(row)];
    if (column >= 0) take(pairs[static_cast<std::size_t>(index(row, column))], predictions, pairing);
  }
}

/// The pairs of the believed tracks, or of the others with sightings that are still free.
std::vector<GatedPair> roundOf(const std::vector<GatedPair>& pairs,
                               const std::vector<TrackPrediction>& predictions, bool believed,
                               const AssociationResult& pairing) {
  std::vector<GatedPair> round;
  for (const GatedPair& pair : pairs) {
    const bool is_free = pairing.prediction_of[static_cast<std::size_t>(pair.sighting)] < 0 &&
                         pairing.sighting_of[static_cast<std::size_t>(pair.track)] < 0;
    if (is_free && predictions[static_cast<std::size_t>(pair.track)].believed == believed)
      round.push_back(pair);
  }
  return round;
}

/// Lets the joint probabilities of all assignments speak for the believed tracks: what their sightings weigh,
/// and how much evidence of the targets the scan is (joint integrated association).
void weighJointly(const Scan& scan, const std::vector<GatedPair>& pairs,
                  const std::vector<TrackPrediction>& predictions, AssociationResult& pairing) {  // (S-35)
  std::vector<double> miss_weight(predictions.size(), 1.0);
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    const double existence = predictions[i].existence;
    miss_weight[i] = 1.0 - existence + existence * missWeight(predictions[i]);
  }
  std::vector<GatedPair> weighted = pairs;
  for (GatedPair& pair : weighted)
    pair.log_ratio += std::log(predictions[static_cast<std::size_t>(pair.track)].existence);
  const JointProbabilities joint = jointProbabilities(weighted, miss_weight);

  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto i = static_cast<std::size_t>(pairs[k].track);
    if (pairing.sighting_of[i] < 0) continue;
    const TrackPrediction& prediction = predictions[i];
    const Sighting& sighting = scan.sightings[static_cast<std::size_t>(pairs[k].sighting)];
    PossibleSighting possible;
    possible.innovation =
        angleDifference(prediction.chart.coordinatesOf(sighting.direction), prediction.state.angles());
    possible.covariance = prediction.noiseOf(sighting);
    possible.probability = joint.paired[k];
    pairing.possible[i].push_back(possible);
  }
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    if (!predictions[i].believed) continue;
    // Of the probability that nothing was its own, the part with a target; then odds after over odds before.
    const double existence = predictions[i].existence;
    const double missed = std::max(joint.missed[i], kLeastMissed);
    const double there =
        1.0 - joint.missed[i] + joint.missed[i] * existence * missWeight(predictions[i]) / miss_weight[i];
    pairing.evidence[i] = there * miss_weight[i] / (missed * existence);
  }
}

}  // namespace

AssociationResult associate(const Scan& scan, const std::vector<TrackPrediction>& predictions,
                            const GateParams& params, double clutter_density, AssociationMethod method,
                            bool with_branches) {
  AssociationResult pairing;
  pairing.possible.resize(predictions.size());
  pairing.sighting_of.assign(predictions.size(), -1);
  pairing.prediction_of.assign(scan.sightings.size(), -1);
  pairing.may_start.assign(scan.sightings.size(), true);
  pairing.decisions.resize(scan.sightings.size());
  for (const TrackPrediction& prediction : predictions) pairing.evidence.push_back(missWeight(prediction));
  for (std::size_t j = 0; j < scan.sightings.size(); ++j)
    pairing.decisions[j].sighting = static_cast<std::uint32_t>(j);

  Candidates candidates =
      candidatesOf(scan, predictions, params, clutter_density, with_branches, pairing.decisions);
  for (const bool believed : {true, false}) {
    const std::vector<GatedPair> round = roundOf(candidates.pairs, predictions, believed, pairing);
    for (const std::vector<int>& cluster : clusters(round))
      assignCluster(round, cluster, predictions, pairing);
    if (believed && method == AssociationMethod::jpda) weighJointly(scan, round, predictions, pairing);
  }
  const std::vector<GatedPair> last_round = roundOf(candidates.changed, predictions, false, pairing);
  for (const std::vector<int>& cluster : clusters(last_round))
    assignCluster(last_round, cluster, predictions, pairing);
  candidates.pairs.insert(candidates.pairs.end(), candidates.changed.begin(), candidates.changed.end());
  candidates.record.insert(candidates.record.end(), candidates.record_of_changed.begin(),
                           candidates.record_of_changed.end());

  for (std::size_t k = 0; k < candidates.pairs.size(); ++k) {
    const GatedPair& pair = candidates.pairs[k];
    const auto j = static_cast<std::size_t>(pair.sighting);
    const bool guards = predictions[static_cast<std::size_t>(pair.track)].guards;
    const bool is_taken = pairing.prediction_of[j] == pair.track;
    if (!is_taken && !(pairing.prediction_of[j] < 0 && guards && pairing.may_start[j])) continue;
    pairing.decisions[j] = candidates.record[k];
    pairing.decisions[j].decision = is_taken ? Decision::accepted : Decision::claimed_by_other;
    pairing.may_start[j] = false;
  }
  pairing.second_looks = std::move(candidates.unlikely);
  return pairing;
}

}  // namespace sightline::core
