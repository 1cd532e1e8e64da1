#include "sightline/core/positions/position_estimator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

using Matrix23d = Eigen::Matrix<double, 2, 3>;

constexpr double kSlotMemory = 5.0;  // time constants of the slow error after which a silent station's goes
constexpr double kFirstInterval =
    2.0;                               // [s] that a station's first measurement counts as being after another
constexpr double kMisfitMemory = 1.0;  // [s]
constexpr double kMostMisfit = 12.0;   // mean normalised innovation squared above which all is started anew
constexpr double kMisfitCap = 30.0;    // what one innovation can add at the most

ModeArray equalAttractions(const PositionEstimatorParams& params) {
  if (params.models.empty() || params.models.size() > kMaxModes) {
    throw std::invalid_argument("PositionEstimatorParams: 1 to " + std::to_string(kMaxModes) +
                                " models are required, got " + std::to_string(params.models.size()));
  }
  for (const PositionModel& model : params.models) {
    if (!(model.ratio >= 0.0 && std::isfinite(model.ratio)))
      throw std::invalid_argument("PositionEstimatorParams: a model's ratio must be >= 0, got " +
                                  std::to_string(model.ratio));
  }
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("PositionEstimatorParams: ") + what + " is required");
  };
  require(params.dwell > 0.0, "dwell > 0 s");
  require(params.scale_memory > 0.0, "scale_memory > 0 s");
  require(params.outlier_distance >= 1.0, "outlier_distance >= 1");
  require(params.alone_after > 0.0, "alone_after > 0 s");
  require(params.alone_intervals > 0.0, "alone_intervals > 0");
  require(params.start_window > 0.0, "start_window > 0 s");
  require(params.max_relative_sigma > 0.0 && params.max_relative_sigma < 1.0,
          "max_relative_sigma between 0 and 1");
  require(params.lost_relative_sigma > params.max_relative_sigma,
          "lost_relative_sigma above max_relative_sigma");
  require(params.fast_share >= 0.0, "fast_share >= 0");
  require(params.fast_time > 0.0, "fast_time > 0 s");
  return ModeArray::Ones(static_cast<Eigen::Index>(params.models.size()));
}

bool isUsable(const StationMeasurement& m) {
  return m.station >= 0 && std::isfinite(m.age) && m.slow.variance >= 0.0 && m.slow.time_constant > 0.0 &&
         isDetermined(m.ray);
}

/// What samples `h` seconds apart of a Gauss-Markov error count like when they are taken as white (P-7).
double whiteEquivalent(double variance, double time_constant, double h) {
  if (!(h > 0.0)) return variance;
  const double phi = std::exp(-h / time_constant);
  return variance * (1.0 + phi) / (1.0 - phi);
}

}  // namespace

std::vector<PositionModel> defaultPositionModels() {
  using Kind = PositionModel::Kind;
  std::vector<PositionModel> models;
  for (const double ratio : {1.0, 1e1, 1e2, 1e3, 1e4}) models.push_back({Kind::white_acceleration, ratio});
  for (const double ratio : {1e1, 1e2, 1e3, 1e4, 1e5, 1e6}) models.push_back({Kind::white_jerk, ratio});
  return models;
}

PositionEstimator::PositionEstimator(const PositionEstimatorParams& params)
    : params_(std::make_shared<const PositionEstimatorParams>(params)),
      chain_(equalAttractions(params), params.dwell),
      seen_(params.alone_after, params.alone_intervals),
      waiting_(params.start_window, params.max_relative_sigma) {}

/// Noise of a measurement over a basis: white, and what of the slow error changes too fast for the state; a
/// station whose slow error is not in the state has all of it here (considered, not estimated).
Eigen::Matrix2d PositionEstimator::noiseOf(const StationMeasurement& m, const Matrix23d& basis, double since,
                                           bool is_in_state) const {  // (P-7)
  Eigen::Matrix2d R = symmetric(basis * m.ray.covariance * basis.transpose());
  const double fast = params_->fast_share * params_->fast_share * m.slow.variance;
  R.diagonal().array() += whiteEquivalent(fast, params_->fast_time, since);
  if (!is_in_state) R.diagonal().array() += whiteEquivalent(m.slow.variance, m.slow.time_constant, since);
  return R;
}

/// Slot of a station's slow error, made when there is room; -1: not in the state.
int PositionEstimator::slotOf(const StationMeasurement& m) {
  for (int i = 0; i < slot_count_; ++i) {
    if (slots_[static_cast<std::size_t>(i)].station != m.station) continue;
    slots_[static_cast<std::size_t>(i)].slow = m.slow;
    return i;
  }
  if (!(m.slow.variance > 0.0)) return -1;
  if (slot_count_ == kMostStations) {  // that of a station which is gone, if there is one
    int oldest = -1;
    for (int i = 0; i < slot_count_; ++i) {
      const SeenStation* seen = seen_.find(slots_[static_cast<std::size_t>(i)].station);
      if (seen && seen_.supports(*seen, m.time)) continue;
      if (oldest < 0 || !seen ||
          seen->last < seen_.find(slots_[static_cast<std::size_t>(oldest)].station)->last)
        oldest = i;
      if (!seen) break;
    }
    if (oldest < 0) return -1;
    dropSlot(oldest);
  }
  Slot& slot = slots_[static_cast<std::size_t>(slot_count_)];
  slot.station = m.station;
  slot.slow = m.slow;
  slot.basis = acrossBasis(m.ray.direction);
  for (Eigen::Index mode = 0; mode < chain_.probabilities().size(); ++mode)
    addSlot(beliefs_[static_cast<std::size_t>(mode)], m.slow.variance);
  return slot_count_++;
}

void PositionEstimator::dropSlot(int slot) {
  for (Eigen::Index mode = 0; mode < chain_.probabilities().size(); ++mode)
    removeSlot(beliefs_[static_cast<std::size_t>(mode)], slot);
  for (int i = slot; i + 1 < slot_count_; ++i)
    slots_[static_cast<std::size_t>(i)] = slots_[static_cast<std::size_t>(i) + 1];
  --slot_count_;
}

void PositionEstimator::start(const PositionBelief& belief, Time now) {
  for (Eigen::Index mode = 0; mode < chain_.probabilities().size(); ++mode)
    beliefs_[static_cast<std::size_t>(mode)] = belief;
  chain_ = ModeChain(ModeArray::Ones(chain_.probabilities().size()), params_->dwell);
  scale_shape_ = scale_sum_ = 1.0;
  slot_count_ = 0;
  has_state_ = true;
  time_ = now;
  misfit_ = 1.0;
  along_floor_.reset();
  waiting_.clear();
}

/// The position is lost; what was seen last is the first to start anew with.
void PositionEstimator::giveUp(const StationMeasurement& last) {
  has_state_ = false;
  waiting_.clear();
  waiting_.wait(last);
  along_floor_.reset();
}

/// Of the models' densities, for a step that ends at `time`.
double PositionEstimator::unitSquaredAt(Time time) const {
  return seen_.unitSquared(mixed(chain_.probabilities(), beliefs_).mean.head<3>(), time);
}

PositionStep PositionEstimator::standingStep() const {
  const auto models = static_cast<std::size_t>(chain_.probabilities().size());
  PositionStep step{
      {beliefs_.begin(), beliefs_.begin() + static_cast<std::ptrdiff_t>(models)}, chain_, 0.0, 0.0, {}, {}};
  for (int i = 0; i < slot_count_; ++i) {
    const Slot& slot = slots_[static_cast<std::size_t>(i)];
    step.slow[static_cast<std::size_t>(i)] = slot.slow;
    step.stations.push_back(slot.station);
  }
  return step;
}

/// Interaction and prediction of all models.
void PositionEstimator::moveTo(Time time) {  // (S-25), (S-26), (P-4)
  const double h = seconds(time - *time_);
  if (!(h > 0.0)) return;
  const ModeArray own = chain_.ownShares(h);
  const ModeArray& weights = chain_.probabilities();
  const PositionBelief all = mixed(weights, beliefs_);
  std::array<SlowError, kMostStations> slow;
  for (int i = 0; i < slot_count_; ++i)
    slow[static_cast<std::size_t>(i)] = slots_[static_cast<std::size_t>(i)].slow;
  const double unit_squared = seen_.unitSquared(all.mean.head<3>(), time);
  const double kept = std::max(std::exp(-h / params_->scale_memory) * scale_shape_, 1.0);
  scale_sum_ *= kept / scale_shape_;  // (S-11): at least one sighting's worth
  scale_shape_ = kept;
  for (Eigen::Index mode = 0; mode < weights.size(); ++mode) {
    const auto at = static_cast<std::size_t>(mode);
    PositionBelief& belief = beliefs_[at];
    const PositionVector offset = belief.mean - all.mean;
    const double share = own(mode);
    belief.mean = all.mean + share * offset;
    belief.covariance = share * belief.covariance + (1.0 - share) * all.covariance;
    belief.covariance.noalias() += (share * (1.0 - share) * offset) * offset.transpose();
    predict(belief, params_->models[at], unit_squared, h, slow);
  }
  time_ = time;
}

PositionBelief PositionEstimator::mixed(
    const ModeArray& weights, const std::array<PositionBelief, kMaxModes>& beliefs) const {  // (S-6)
  const Eigen::Index n = beliefs[0].mean.size();
  PositionBelief all;
  all.mean = PositionVector::Zero(n);
  all.covariance = PositionMatrix::Zero(n, n);
  for (Eigen::Index mode = 0; mode < weights.size(); ++mode)
    all.mean += weights(mode) * beliefs[static_cast<std::size_t>(mode)].mean;
  for (Eigen::Index mode = 0; mode < weights.size(); ++mode) {
    const PositionBelief& belief = beliefs[static_cast<std::size_t>(mode)];
    const PositionVector offset = belief.mean - all.mean;
    all.covariance += weights(mode) * belief.covariance;
    all.covariance.noalias() += (weights(mode) * offset) * offset.transpose();
  }
  return all;
}

/// (P-6): what is known along the ray of a station that is alone never becomes better.
void PositionEstimator::keepAlongRay(const Eigen::Vector3d& origin) {
  const PositionBelief all = mixed(chain_.probabilities(), beliefs_);
  const Eigen::Vector3d v = (all.mean.head<3>() - origin).normalized();
  const double variance = v.dot(all.covariance.topLeftCorner<3, 3>() * v);
  const double missing = along_floor_ ? *along_floor_ - variance : 0.0;
  if (missing > 0.0) {
    for (Eigen::Index mode = 0; mode < chain_.probabilities().size(); ++mode)
      beliefs_[static_cast<std::size_t>(mode)].covariance.topLeftCorner<3, 3>() +=
          missing * v * v.transpose();
  }
  along_floor_ = std::max(variance, along_floor_.value_or(0.0));
}

MeasurementUse PositionEstimator::take(const StationMeasurement& m, std::optional<PositionStep>* step) {
  if (!isUsable(m)) return MeasurementUse::refused;
  const std::optional<Time> newest = has_state_ ? time_ : waiting_.newest();
  if (newest && m.time < *newest) return MeasurementUse::refused;
  const SeenStation* before = seen_.find(m.station);
  const double since = before ? seconds(m.time - before->last) : kFirstInterval;
  SeenStation& seen = seen_.note(m);

  if (!has_state_) {
    waiting_.wait(m);
    const auto belief = waiting_.startAt(m.time);
    if (!belief) return MeasurementUse::waiting;
    start(*belief, m.time);
    return MeasurementUse::started;
  }

  const double h = seconds(m.time - *time_);
  if (step) {
    *step = standingStep();
    (*step)->h = h;
    (*step)->unit_squared = unitSquaredAt(m.time);
  }
  moveTo(m.time);
  for (int i = slot_count_ - 1; i >= 0; --i) {  // the slow errors of stations long silent are forgotten
    const Slot& slot = slots_[static_cast<std::size_t>(i)];
    const SeenStation* other = seen_.find(slot.station);
    if (!other || seconds(m.time - other->last) > kSlotMemory * slot.slow.time_constant) dropSlot(i);
  }
  const int slot = slotOf(m);
  DirectionUpdate direction;
  direction.origin = m.ray.origin;
  direction.direction = m.ray.direction;
  direction.slot = slot;
  direction.age = m.age;
  Matrix23d basis = acrossBasis(m.ray.direction);
  if (slot >= 0) {  // carried along with the line of sight
    Matrix23d& carried = slots_[static_cast<std::size_t>(slot)].basis;
    Matrix23d near = carried - carried * m.ray.direction * m.ray.direction.transpose();
    if (near.row(0).norm() > 0.1) {
      near.row(0).normalize();
      near.row(1) = m.ray.direction.cross(near.row(0).transpose()).transpose();
      carried = near;
    } else {
      carried = basis;
    }
    basis = carried;
  }
  direction.basis = basis;
  direction.R = noiseOf(m, basis, since, slot >= 0);

  const Eigen::Vector3d point = beliefs_[0].mean.head<3>();
  const bool is_alone = seen_.isAlone(seen, point, m.time);
  if (!is_alone || !along_floor_) seen.alone_origin = m.ray.origin;
  seen.is_at_rest = SeenStations::isAtRest(seen, m.ray.origin, point);
  const bool keeps_range = is_alone && seen.is_at_rest;

  // Evidence of the models (P-8): the innovations' scale is common to all and at most as stated, because the
  // noise is an upper bound; a calm model may not explain a manoeuvre by noise.
  ModeArray log_likelihoods(chain_.probabilities().size());
  ModeArray distances(log_likelihoods.size());
  const double a = scale_shape_, b = scale_sum_;
  for (Eigen::Index mode = 0; mode < log_likelihoods.size(); ++mode) {
    const auto at = static_cast<std::size_t>(mode);
    const UpdateResult result = keeps_range
                                    ? core::updateAlone(beliefs_[at], direction, params_->outlier_distance)
                                    : core::update(beliefs_[at], direction, params_->outlier_distance);
    distances(mode) =
        result.is_behind ? 2.0 * kMisfitCap : std::min(result.distance_squared, 2.0 * kMisfitCap);
    log_likelihoods(mode) =
        -0.5 * result.log_determinant - (a + 1.0) * std::log1p(distances(mode) / (2.0 * b));
  }
  chain_.update(h, log_likelihoods);
  const double misfit = 0.5 * (chain_.probabilities() * distances).sum();
  scale_shape_ += 1.0;
  scale_sum_ = std::min(scale_sum_ + misfit, scale_shape_);
  misfit_ += (1.0 - std::exp(-std::max(h, 1e-3) / kMisfitMemory)) * (misfit - misfit_);
  if (keeps_range)
    keepAlongRay(m.ray.origin);
  else
    along_floor_.reset();

  const auto state = stateAt(m.time);
  const bool is_lost = !state || !(state->relative_sigma < params_->lost_relative_sigma);
  if (!is_lost && misfit_ <= kMostMisfit) return MeasurementUse::taken;
  giveUp(m);
  return MeasurementUse::restarted;
}

std::optional<PositionState> PositionEstimator::stateAt(Time time) const {
  if (!has_state_ || time < *time_) return std::nullopt;
  PositionBelief all;
  if (time == *time_) {
    all = mixed(chain_.probabilities(), beliefs_);
  } else {
    PositionEstimator ahead = *this;
    ahead.moveTo(time);
    all = mixed(chain_.predicted(seconds(time - *time_)), ahead.beliefs_);
  }
  if (!all.mean.allFinite() || !all.covariance.allFinite()) return std::nullopt;
  PositionState state;
  state.mean = all.mean.head<6>();
  state.covariance = symmetric(all.covariance.topLeftCorner<6, 6>());
  const SeenStations::Support support = seen_.supportOf(state.mean.head<3>(), time);
  state.stations = support.stations;
  state.parallax = support.parallax;
  state.relative_sigma = largestSigma(state.covariance.topLeftCorner<3, 3>()) / support.nearest;
  return state;
}

std::optional<SlowErrorEstimate> PositionEstimator::slowErrorOf(int station) const {
  if (!has_state_) return std::nullopt;
  for (int i = 0; i < slot_count_; ++i) {
    const Slot& slot = slots_[static_cast<std::size_t>(i)];
    if (slot.station != station) continue;
    const PositionBelief all = mixed(chain_.probabilities(), beliefs_);
    SlowErrorEstimate estimate;
    estimate.station = station;
    estimate.time = *time_;
    if (const SeenStation* seen = seen_.find(station)) estimate.since = seen->since;
    estimate.error = all.mean.segment<2>(kMotionSize + 2 * i);
    estimate.covariance = all.covariance.block<2, 2>(kMotionSize + 2 * i, kMotionSize + 2 * i);
    estimate.basis = slot.basis;
    return estimate;
  }
  return std::nullopt;
}

}  // namespace sightline::core
