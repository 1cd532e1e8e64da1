#include "sightline/ros/outputs/output_tracks.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sightline/core/fusion/track_alignment.h"
#include "sightline/core/model/chart.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/position_messages.h"

namespace sightline_ros {

namespace core = sightline::core;
using core::AngularState;

namespace {

constexpr double kFarthest = 1e12;     // [m]
constexpr double kFastest = 3e8;       // [m/s]
constexpr double kAsymmetry = 1e-6;    // of an entry, relative to the two sigmas
constexpr double kLargestRatio = 1e6;  // density over position variance [1/s^3], as `kLargestDensityRatio`

std::optional<core::Refusal> rejectionOfState(const MetricState& state) {
  if (!state.mean.allFinite() || !state.covariance.allFinite())
    return core::invalid("state or covariance is not finite");
  if (state.position().norm() > kFarthest || state.velocity().norm() > kFastest)
    return core::invalid("position beyond 1e12 m or faster than light: are these metres?");
  const Eigen::Matrix<double, 6, 1> variances = state.covariance.diagonal();
  if (!(variances.minCoeff() > 0.0)) return core::invalid("covariance is not positive definite");
  const Eigen::Matrix<double, 6, 1> per_sigma = variances.cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 6, 6> correlation =
      per_sigma.asDiagonal() * state.covariance * per_sigma.asDiagonal();
  if ((correlation - correlation.transpose()).cwiseAbs().maxCoeff() > kAsymmetry)
    return core::invalid("covariance is not symmetric");
  if (correlation.llt().info() != Eigen::Success) return core::invalid("covariance is not positive definite");
  return std::nullopt;
}

std::optional<core::Refusal> rejectionOfState(const AngularState& state) {
  return core::rejectionOf(state);
}

AngularState stateOf(const sightline::Track& track) {
  return toCore(track).state;
}

MetricState stateOf(const sightline::PositionTrack& track) {
  const core::PositionTrack position = toCore(track);
  MetricState state;
  state.mean << position.position, position.velocity;
  state.covariance = position.covariance;
  return state;
}

template <typename Message>
std::vector<OutputTrack> chosenOf(const Message& message, const OutputChoice& choice,
                                  std::vector<core::Refusal>& refusals) {
  std::vector<OutputTrack> chosen;
  std::set<std::uint32_t> ids;
  for (const auto& track : message.tracks) {
    if (!isChosen(track.status, choice)) continue;
    const std::string name = "track " + std::to_string(track.id);
    const auto state = stateOf(track);
    if (const auto rejection = rejectionOfState(state)) {
      refusals.push_back({rejection->kind, name + ": " + rejection->detail});
    } else if (!ids.insert(track.id).second) {
      refusals.push_back(core::invalid(name + " is twice in one message: ids must differ"));
    } else {
      chosen.push_back({track.id, track.status, track.existence, state});
    }
  }
  std::sort(chosen.begin(), chosen.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  const auto most = static_cast<std::size_t>(choice.max_tracks);
  if (chosen.size() > most) {
    refusals.push_back({"limit", std::to_string(chosen.size()) + " tracks are more than ~max_tracks (" +
                                     std::to_string(most) + "): those of the highest ids are left out"});
    chosen.resize(most);
  }
  return chosen;
}

/// (S-17) with the density of each axis that its variances imply.
MetricState predictedPosition(const MetricState& state, double h) {
  Eigen::Matrix<double, 6, 6> F = Eigen::Matrix<double, 6, 6>::Identity();
  F.topRightCorner<3, 3>().diagonal().setConstant(h);
  MetricState later{F * state.mean, F * state.covariance * F.transpose()};
  const double age = std::abs(h);
  for (int axis = 0; axis < 3; ++axis) {
    const double P11 = state.covariance(axis, axis), P22 = state.covariance(axis + 3, axis + 3);
    const double q = std::min(P22 * std::sqrt(0.5 * P22 / P11), kLargestRatio * P11);
    later.covariance(axis, axis) += q * age * age * age / 3.0;
    later.covariance(axis, axis + 3) += q * h * age / 2.0;
    later.covariance(axis + 3, axis) += q * h * age / 2.0;
    later.covariance(axis + 3, axis + 3) += q * age;
  }
  later.covariance = core::symmetric(later.covariance);
  return later;
}

AngularState predictedDirection(const AngularState& state, double h) {
  const core::Chart chart = core::Chart::around(core::directionOf(state.angles()));
  const AngularState charted = chart.fromTracking(state);
  return chart.toTracking(core::propagate(charted, h, core::impliedProcessNoise(charted.covariance)));
}

double largestSigmaOf(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues().maxCoeff(), 0.0));
}

}  // namespace

bool isChosen(std::uint8_t status, const OutputChoice& choice) {
  return status == sightline::Track::CONFIRMED || (status == sightline::Track::COASTING && choice.coasting) ||
         (status == sightline::Track::TENTATIVE && choice.tentative);
}

OutputTracks outputTracksOf(const sightline::TrackArray& message, const OutputChoice& choice,
                            std::vector<core::Refusal>& refusals) {
  return {message.header, false, chosenOf(message, choice, refusals)};
}

OutputTracks outputTracksOf(const sightline::PositionTrackArray& message, const OutputChoice& choice,
                            std::vector<core::Refusal>& refusals) {
  return {message.header, true, chosenOf(message, choice, refusals)};
}

OutputTrack predicted(const OutputTrack& track, double h) {
  OutputTrack later = track;
  if (const auto* direction = std::get_if<AngularState>(&track.state))
    later.state = predictedDirection(*direction, h);
  else
    later.state = predictedPosition(std::get<MetricState>(track.state), h);
  return later;
}

Eigen::Vector3d placeOf(const OutputTrack& track, double distance) {
  if (const auto* direction = std::get_if<AngularState>(&track.state))
    return distance * core::directionOf(direction->angles());
  return std::get<MetricState>(track.state).position();
}

Eigen::Matrix3d attitudeOf(const OutputTrack& track) {
  if (const auto* direction = std::get_if<AngularState>(&track.state))
    return attitudeAlong(core::directionOf(direction->angles()));
  return attitudeAlong(std::get<MetricState>(track.state).velocity());
}

Eigen::Matrix3d attitudeAlong(const Eigen::Vector3d& forward) {
  if (!(forward.norm() > 0.0)) return Eigen::Matrix3d::Identity();
  const Eigen::Vector2d angles = core::anglesOf(forward);
  return (Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(-angles.y(), Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

double largestSigma(const OutputTrack& track) {
  if (const auto* direction = std::get_if<AngularState>(&track.state))
    return core::largestPositionSigma(*direction);
  return largestSigmaOf(std::get<MetricState>(track.state).covariance.topLeftCorner<3, 3>());
}

SeenDirection seenFrom(const Eigen::Isometry3d& view_tracks, const OutputTrack& track) {
  if (const auto* direction = std::get_if<AngularState>(&track.state)) {
    return {(view_tracks.linear() * core::directionOf(direction->angles())).normalized(),
            core::largestPositionSigma(*direction)};
  }
  const auto& state = std::get<MetricState>(track.state);
  const Eigen::Vector3d ray = view_tracks * state.position();
  const double range = ray.norm();
  if (!(range > 0.0)) return {Eigen::Vector3d::UnitX(), std::numeric_limits<double>::infinity()};
  const Eigen::Vector3d d = ray / range;
  const Eigen::Matrix3d T = (Eigen::Matrix3d::Identity() - d * d.transpose()) * view_tracks.linear();
  return {d, largestSigmaOf(T * state.covariance.topLeftCorner<3, 3>() * T.transpose()) / range};
}

}  // namespace sightline_ros
