#include "sightline/core/fusion/global_track.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include <Eigen/Cholesky>

#include "sightline/core/fusion/track_alignment.h"

namespace sightline::core {
namespace {

Estimate<4> estimateOf(AngularState state, const Eigen::Vector3d& acceleration, double age,
                       const Chart& chart) {
  allowFor(acceleration, age, chart, state);
  return {state.mean, state.covariance};
}

/// What estimates say together, as if independent; nullopt when there are none.
std::optional<Estimate<4>> together(const std::vector<Estimate<4>>& estimates) {
  const auto fused = weightedCovariance(estimates);
  if (!fused) return std::nullopt;
  return Estimate<4>{fused->mean, fused->covariance};
}

}  // namespace

double distanceSquared(const Estimate<4>& a, const Estimate<4>& b, double registration_sigma) {
  Eigen::Matrix4d S = a.covariance + b.covariance;
  S.topLeftCorner<2, 2>().diagonal().array() += registration_sigma * registration_sigma;
  const Eigen::LLT<Eigen::Matrix4d> factor(S);
  const double distance = factor.matrixL().solve(a.mean - b.mean).squaredNorm();
  return factor.info() == Eigen::Success && distance >= 0.0 ? distance
                                                            : std::numeric_limits<double>::infinity();
}

GlobalTrack::GlobalTrack(std::uint32_t id, Time time, const LocalKey& key, const LocalTrack& local,
                         double process_noise)
    : id_(id),
      process_noise_(process_noise),
      chart_(Chart::around(directionOf(local.track.state.angles()))),
      time_(time),
      last_fusion_(time) {
  join(key, local);
  state_ = supporters_.front().state;
  density_ = supporters_.front().density;
}

std::size_t GlobalTrack::numberOf(const std::string& tracker) const {
  const auto found =
      std::find_if(supporters_.begin(), supporters_.end(),
                   [&tracker](const Supporter& supporter) { return supporter.key.tracker == tracker; });
  return static_cast<std::size_t>(found - supporters_.begin());
}

bool GlobalTrack::hasTracker(const std::string& tracker) const {
  return numberOf(tracker) < supporters_.size();
}

bool GlobalTrack::hasAnyTrackerOf(const GlobalTrack& other) const {
  return std::any_of(supporters_.begin(), supporters_.end(), [&other](const Supporter& supporter) {
    return other.hasTracker(supporter.key.tracker);
  });
}

Eigen::Vector2d GlobalTrack::densityOf(const Eigen::Matrix4d& covariance) const {
  return process_noise_ > 0.0 ? Eigen::Vector2d::Constant(process_noise_) : impliedProcessNoise(covariance);
}

void GlobalTrack::advance(Time time) {
  const double h = seconds(time - time_);
  time_ = time;
  if (h <= 0.0) return;
  std::vector<Eigen::Vector2d> densities;
  for (Supporter& supporter : supporters_) {
    supporter.state = propagate(supporter.state, h, supporter.density);
    densities.push_back(supporter.density);
  }
  cross_.predict(h, densities);
  state_ = propagate(state_, h, density_);
}

AngularState GlobalTrack::aligned(const AngularState& state_tracking, Time from, Time to) const {
  const AngularState state = chart_.fromTracking(state_tracking);
  return propagate(state, seconds(to - from), densityOf(state.covariance));
}

Estimate<4> GlobalTrack::estimateOf(const LocalTrack& local, Time time) const {
  return estimateAt({local.time, local.track.state}, local.acceleration.value(), time);
}

Estimate<4> GlobalTrack::estimateAt(const ReportedState& reported, const Eigen::Vector3d& acceleration,
                                    Time time) const {
  return sightline::core::estimateOf(aligned(reported.state, reported.time, time), acceleration,
                                     seconds(time - reported.time), chart_);
}

Estimate<4> GlobalTrack::estimateAt(std::size_t supporter, Time past) const {
  const LocalTrack& local = supporters_[supporter].local;
  const ReportedState newest{local.time, local.track.state};
  const ReportedState* former = supporters_[supporter].former.nearest(past);
  const bool is_former =
      former != nullptr && std::abs(seconds(former->time - past)) < std::abs(seconds(newest.time - past));
  return estimateAt(is_former ? *former : newest, local.acceleration.value(), past);
}

std::optional<Estimate<4>> GlobalTrack::opinionAt(const std::vector<std::size_t>& supporters,
                                                  Time past) const {
  std::vector<Estimate<4>> estimates;
  for (const std::size_t number : supporters) estimates.push_back(estimateAt(number, past));
  return together(estimates);
}

Estimate<4> GlobalTrack::estimateOf(std::size_t supporter) const {
  const Supporter& it = supporters_[supporter];
  return sightline::core::estimateOf(it.state, it.local.acceleration.value(), seconds(time_ - it.local.time),
                                     chart_);
}

Supporter GlobalTrack::supporterOf(const LocalKey& key, const LocalTrack& local) const {
  Supporter supporter;
  supporter.key = key;
  supporter.local = local;
  supporter.density = densityOf(chart_.fromTracking(local.track.state).covariance);
  supporter.state = aligned(local.track.state, local.time, time_);
  return supporter;
}

void GlobalTrack::join(const LocalKey& key, const LocalTrack& local) {
  supporters_.push_back(supporterOf(key, local));
  cross_.add();
}

double GlobalTrack::renew(std::size_t supporter, const LocalTrack& local) {
  Supporter& old = supporters_[supporter];
  Supporter renewed = supporterOf(old.key, local);
  renewed.former = std::move(old.former);
  renewed.former.add({old.local.time, old.local.track.state});
  renewed.contributed = old.contributed;
  renewed.contradicts_since = old.contradicts_since;
  renewed.misplaced_since = old.misplaced_since;
  const double surprise = distanceSquared({old.state.mean, old.state.covariance},
                                          {renewed.state.mean, renewed.state.covariance}, 0.0);
  cross_.update(supporter, old.state.covariance, renewed.state.covariance);
  old = std::move(renewed);
  return surprise;
}

void GlobalTrack::leave(std::size_t supporter) {
  supporters_.erase(supporters_.begin() + static_cast<std::ptrdiff_t>(supporter));
  cross_.remove(supporter);
}

std::optional<Time> GlobalTrack::setMisplaced(std::size_t supporter, bool is_misplaced) {
  std::optional<Time>& since = supporters_[supporter].misplaced_since;
  if (!is_misplaced) since.reset();
  if (is_misplaced && !since) since = time_;
  return since;
}

void GlobalTrack::setUnusable(std::size_t supporter, std::optional<Refusal> why) {
  supporters_[supporter].unusable = std::move(why);
  supporters_[supporter].distance_squared = std::numeric_limits<double>::quiet_NaN();
}

void GlobalTrack::absorb(const GlobalTrack& other) {
  for (Supporter supporter : other.supporters_) {
    supporter.state = chart_.fromTracking(other.chart_.toTracking(supporter.state));
    supporters_.push_back(std::move(supporter));
    cross_.add();
  }
}

std::vector<std::size_t> GlobalTrack::usable() const {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < supporters_.size(); ++i) {
    if (!supporters_[i].unusable) numbers.push_back(i);
  }
  return numbers;
}

void GlobalTrack::compareSupporters(const TrackerMisalignment& registration) {
  const std::vector<std::size_t> numbers = usable();
  std::vector<Estimate<4>> estimates;
  for (const std::size_t number : numbers) estimates.push_back(estimateOf(number));
  const auto others = weightedCovarianceOfOthers(estimates);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    double& distance_squared = supporters_[numbers[i]].distance_squared;
    distance_squared = std::numeric_limits<double>::quiet_NaN();
    if (numbers.size() < 2) return;
    distance_squared = others[i] ? distanceSquared(estimates[i], *others[i],
                                                   registration.sigma(supporters_[numbers[i]].key.tracker))
                                 : std::numeric_limits<double>::infinity();
  }
}

/// Whether a supporter agrees with the others as of the newest instant for which both have reported.
bool GlobalTrack::agreesInThePast(std::size_t supporter, double registration_sigma, double threshold) const {
  std::vector<std::size_t> others = usable();
  others.erase(std::remove(others.begin(), others.end(), supporter), others.end());
  const std::optional<Time> of_others = newestReport(others);
  if (!of_others) return false;
  const Time past = std::min(*of_others, supporters_[supporter].local.time);
  const std::optional<Estimate<4>> opinion = opinionAt(others, past);
  return opinion && distanceSquared(estimateAt(supporter, past), *opinion, registration_sigma) < threshold;
}

/// Of two that contradict each other the one whose report is older, as a prediction may have become wrong;
/// else that which came later.
std::size_t GlobalTrack::doubtfulOf(std::size_t first, std::size_t second) const {
  return supporters_[first].local.time < supporters_[second].local.time ? first : second;
}

std::vector<std::size_t> GlobalTrack::leaveOutContradictions(const TrackerMisalignment& registration,
                                                             double threshold,
                                                             const NewReports& new_reports) {
  const std::size_t asked = usable().size();
  std::vector<std::size_t> contradicting;
  for (;;) {
    compareSupporters(registration);
    const std::vector<std::size_t> numbers = usable();
    std::size_t worst = supporters_.size();
    double farthest = threshold;
    for (const std::size_t number : numbers) {
      if (!(supporters_[number].distance_squared >= farthest)) continue;  // NaN: nobody to contradict
      farthest = supporters_[number].distance_squared;
      worst = number;
    }
    if (worst == supporters_.size()) break;
    if (numbers.size() == 2) worst = doubtfulOf(numbers[0], numbers[1]);
    std::ostringstream why;
    why << "distance squared " << farthest << " from the other local tracks (" << threshold << " allowed)";
    Supporter& it = supporters_[worst];
    if (agreesInThePast(worst, registration.sigma(it.key.tracker), threshold)) {
      why << " after " << seconds(time_ - it.local.time)
          << " s of prediction; they agreed when it was reported";
      it.unusable = Refusal{"late", why.str()};
      it.contradicts_since.reset();
    } else {
      contradicting.push_back(worst);
      it.unusable = Refusal{"contradiction", why.str()};
    }
  }
  if (2 * contradicting.size() > asked) {  // no majority agrees: whoever is left is left by chance
    for (const std::size_t number : contradicting) supporters_[number].unusable.reset();
    compareSupporters(registration);
    return {};
  }
  for (const std::size_t number : contradicting) {
    if (!supporters_[number].contradicts_since) supporters_[number].contradicts_since = time_;
  }
  for (const std::size_t number : usable()) {
    if (new_reports.count(supporters_[number].key.tracker) > 0) supporters_[number].contradicts_since.reset();
  }
  std::sort(contradicting.begin(), contradicting.end());
  return contradicting;
}

Estimate<4> GlobalTrack::opinion() const {
  std::vector<Estimate<4>> estimates;
  for (const std::size_t number : usable()) estimates.push_back(estimateOf(number));
  const std::optional<Estimate<4>> all = together(estimates);
  return all ? *all
             : sightline::core::estimateOf(state_, acceleration_, seconds(time_ - last_fusion_), chart_);
}

std::optional<Estimate<4>> GlobalTrack::opinionAt(Time past) const {
  return opinionAt(usable(), past);
}

std::optional<Time> GlobalTrack::newestReport() const {
  return newestReport(usable());
}

std::optional<Time> GlobalTrack::newestReport(const std::vector<std::size_t>& supporters) const {
  std::optional<Time> newest;
  for (const std::size_t number : supporters)
    newest = std::max(newest.value_or(Time::min()), supporters_[number].local.time);
  return newest;
}

std::optional<Estimate<4>> GlobalTrack::opinionWithout(const std::string& tracker) const {
  std::vector<Estimate<4>> estimates;
  for (const std::size_t number : usable()) {
    if (supporters_[number].key.tracker != tracker) estimates.push_back(estimateOf(number));
  }
  return together(estimates);
}

void GlobalTrack::setFused(const std::vector<std::size_t>& contributors, const AngularState& fused) {
  state_ = fused;
  last_fusion_ = time_;
  if (!chart_.holds(state_.angles())) moveToChart(Chart::around(chart_.directionAt(state_.angles())));

  for (Supporter& supporter : supporters_) supporter.contributed = false;
  density_.setZero();
  acceleration_.setZero();
  for (const std::size_t number : contributors) {
    supporters_[number].contributed = true;
    acceleration_ +=
        supporters_[number].local.acceleration.value() / static_cast<double>(contributors.size());
    density_ = density_.cwiseMax(supporters_[number].density);
  }
}

void GlobalTrack::moveToChart(const Chart& chart) {
  const Eigen::Matrix3d R_new_old = chart.R_chart_tracking() * chart_.R_chart_tracking().transpose();
  std::vector<Eigen::Matrix4d> jacobians;
  for (Supporter& supporter : supporters_) {
    jacobians.push_back(rotateStateJacobian(supporter.state.mean, R_new_old));
    supporter.state = rotateState(supporter.state, R_new_old);
    supporter.density = densityOf(supporter.state.covariance);
  }
  cross_.transform(jacobians);
  state_ = rotateState(state_, R_new_old);
  chart_ = chart;
}

}  // namespace sightline::core
