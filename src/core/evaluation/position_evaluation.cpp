#include "sightline/core/evaluation/position_evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sightline/core/association/assignment.h"
#include "sightline/core/evaluation/gospa.h"

namespace sightline::core {
namespace {

constexpr std::size_t kMostSamples = 1'000'000;  // kept for the quantiles
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The value below which the share of all lies; NaN of none.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNaN;
  const auto place = static_cast<std::ptrdiff_t>(
      std::min(share * static_cast<double>(values.size()), static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

double neesOf(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  if (llt.info() != Eigen::Success || !covariance.allFinite()) return kNaN;
  return error.dot(llt.solve(error)) / 3.0;
}

double largestSigma(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return 0.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues().maxCoeff(), 0.0));
}

}  // namespace

Eigen::Vector3d TruePath::velocityAt(Sample sample) const {
  Sample before = sample, after = std::next(sample);
  if (sample != samples_.begin() && seconds(sample->first - std::prev(sample)->first) <= gap_)
    before = std::prev(sample);
  if (after == samples_.end() || seconds(after->first - sample->first) > gap_) after = sample;
  if (before == after) return Eigen::Vector3d::Zero();
  if (before == sample || after == sample)
    return (after->second - before->second) / seconds(after->first - before->first);
  // Of the parabola through the three.
  const double a = seconds(sample->first - before->first), b = seconds(after->first - sample->first);
  return ((sample->second - before->second) / a * b + (after->second - sample->second) / b * a) / (a + b);
}

std::optional<PositionTruth> TruePath::at(Time time) const {
  const Sample after = samples_.lower_bound(time);
  if (after == samples_.end()) return std::nullopt;
  if (after->first == time) return PositionTruth{after->second, velocityAt(after)};
  if (after == samples_.begin()) return std::nullopt;
  const Sample before = std::prev(after);
  const double h = seconds(after->first - before->first);
  if (h > gap_) return std::nullopt;
  const double s = seconds(time - before->first) / h, r = 1.0 - s;
  const Eigen::Vector3d p = before->second, q = after->second;
  const Eigen::Vector3d u = h * velocityAt(before), v = h * velocityAt(after);
  PositionTruth truth;
  truth.position = r * r * (1.0 + 2.0 * s) * p + s * s * (3.0 - 2.0 * s) * q + s * r * r * u - s * s * r * v;
  truth.velocity = (6.0 * s * r * (q - p) + r * (1.0 - 3.0 * s) * u + s * (3.0 * s - 2.0) * v) / h;
  return truth;
}

PositionEvaluation::PositionEvaluation(const std::map<std::string, TruePath>& truth,
                                       const PositionEvaluationParams& params)
    : truth_(&truth), params_(params) {}

bool PositionEvaluation::isKnown(Time time) const {
  return std::any_of(truth_->begin(), truth_->end(), [time](const auto& path) {
    const auto& samples = path.second.samples();
    return !samples.empty() && samples.begin()->first <= time && time <= samples.rbegin()->first;
  });
}

std::vector<PositionEvaluation::Pair> PositionEvaluation::add(Time time,
                                                              const std::vector<EstimatedPosition>& tracks) {
  last_gospa_.reset();
  if (!isKnown(time)) return {};
  std::vector<std::string> names;
  std::vector<PositionTruth> truths;
  for (const auto& [name, path] : *truth_) {
    Target& target = targets_[name];
    const auto truth = path.at(time);
    if (!truth) {
      target.since.reset();
      target.had_track = false;  // it went, and its track with it
      continue;
    }
    if (!target.since) target.since = time;
    names.push_back(name);
    truths.push_back(*truth);
  }

  const double c = params_.gospa_cutoff;
  Eigen::MatrixXd distance = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(tracks.size()),
                                                       static_cast<Eigen::Index>(truths.size()), kForbidden);
  Eigen::MatrixXd within_cutoff = distance;  // for GOSPA
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const double reach = std::max(c, params_.match_sigmas * largestSigma(tracks[i].covariance));
    for (std::size_t j = 0; j < truths.size(); ++j) {
      const double d = (tracks[i].position - truths[j].position).norm();
      const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
      if (d <= reach) distance(row, column) = d;
      if (d <= c) within_cutoff(row, column) = d;
    }
  }
  last_gospa_ = gospaOfDistances(within_cutoff, {c, 2.0});
  gospa_.add(last_gospa_->distance);
  ++reports_;

  std::vector<Pair> pairs;
  std::vector<bool> is_covered(truths.size(), false);
  const std::vector<int> partner = assign(distance);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const EstimatedPosition& track = tracks[i];
    ids_.insert(track.id);
    ++track_reports_;
    if (partner[i] < 0) {
      ++false_reports_;
      continue;
    }
    const auto j = static_cast<std::size_t>(partner[i]);
    true_ids_.insert(track.id);
    is_covered[j] = true;
    Target& target = targets_[names[j]];
    if (target.last_id && *target.last_id != track.id) ++id_changes_;
    target.last_id = track.id;
    if (seconds(time - *target.since) < params_.settle) continue;
    Pair pair;
    pair.target = names[j];
    pair.id = track.id;
    pair.error = track.position - truths[j].position;
    pair.sigma = track.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    pair.nees = neesOf(pair.error, track.covariance);
    pair.is_alone = track.is_alone;
    for (Sums* sums : {&all_, track.is_alone ? &alone_ : nullptr}) {
      if (sums == nullptr) continue;
      sums->add(pair.error.norm(), (track.velocity - truths[j].velocity).norm());
      if (std::isfinite(pair.nees)) sums->nees.add(pair.nees);
    }
    pairs.push_back(pair);
  }
  for (std::size_t j = 0; j < truths.size(); ++j) {
    Target& target = targets_[names[j]];
    if (target.had_track && !is_covered[j]) ++breaks_;
    target.had_track = is_covered[j];
    if (seconds(time - *target.since) < params_.settle) continue;
    ++present_;
    if (is_covered[j]) ++covered_;
  }
  return pairs;
}

void PositionEvaluation::Sums::add(double distance, double velocity) {
  squares.add(distance * distance);
  if (samples++ % stride != 0) return;
  distances.push_back(distance);
  velocities.push_back(velocity);
  if (distances.size() < kMostSamples) return;
  for (std::vector<double>* values : {&distances, &velocities}) {
    for (std::size_t i = 0; 2 * i < values->size(); ++i) (*values)[i] = (*values)[2 * i];
    values->resize((values->size() + 1) / 2);
  }
  stride *= 2;
}

PositionErrors PositionEvaluation::Sums::errors() const {
  PositionErrors errors;
  errors.samples = samples;
  errors.rmse = std::sqrt(squares.mean());
  errors.median = quantile(distances, 0.5);
  errors.p90 = quantile(distances, 0.9);
  errors.p95 = quantile(distances, 0.95);
  errors.median_velocity = quantile(velocities, 0.5);
  errors.anees = nees.mean();
  return errors;
}

PositionRow PositionEvaluation::row() const {
  const auto share = [](std::uint64_t part, std::uint64_t all) {
    return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : kNaN;
  };
  PositionRow row;
  row.reports = reports_;
  row.all = all_.errors();
  row.alone = alone_.errors();
  row.coverage = share(covered_, present_);
  row.breaks = breaks_;
  row.id_changes = id_changes_;
  row.tracks = ids_.size();
  row.false_tracks = ids_.size() - true_ids_.size();
  row.false_share = share(false_reports_, track_reports_);
  row.gospa = gospa_.mean();
  return row;
}

}  // namespace sightline::core
