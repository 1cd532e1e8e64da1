#include "sightline/core/positions/stations/station_correction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr int kStates = StationAlignment::kStates;

/// What may be off at a station.
struct Off {
  bool clock = false, orientation = false;

  bool any() const { return clock || orientation; }
  bool operator==(const Off& other) const { return clock == other.clock && orientation == other.orientation; }
};

/// The other way of a station being off that explains the data better, and by how much.
struct Gain {
  Off off;
  double value = 0.0;  // log evidence ratio
};

Eigen::Matrix<double, 3, 3> skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

double logDeterminant(const Eigen::Matrix4d& m) {
  const Eigen::LLT<Eigen::Matrix4d> llt(m);
  return 2.0 * llt.matrixLLT().diagonal().array().log().sum();
}

constexpr std::array<Off, 3> kWaysOfBeingOff{Off{true, false}, Off{false, true}, Off{true, true}};

/// What the stations that are known say together, under the hypothesis that some of them are off (P-16).
class Evidence {
 public:
  Evidence(const StationCorrectionParams& normal, const StationAlignmentParams& wide,
           const StationAlignment& alignment)
      : normal_(normal), wide_(wide) {
    for (int station = 0; station < alignment.stations(); ++station)
      if (alignment.knows(station)) stations_.push_back(station);
    offs_.resize(size());
    if (stations_.empty()) return;
    const StationAlignment::Equations all = alignment.equations();
    information_.resize(rows(), rows());
    vector_.resize(rows());
    for (std::size_t i = 0; i < size(); ++i) {
      vector_.segment<kStates>(rowOf(i)) = all.vector.segment<kStates>(kStates * stations_[i]);
      for (std::size_t j = 0; j < size(); ++j)
        information_.block<kStates, kStates>(rowOf(i), rowOf(j)) =
            all.information.block<kStates, kStates>(kStates * stations_[i], kStates * stations_[j]);
    }
    solve();
  }

  std::size_t size() const { return stations_.size(); }
  int station(std::size_t i) const { return stations_[i]; }
  const std::vector<int>& stations() const { return stations_; }
  const Off& off(std::size_t i) const { return offs_[i]; }

  void suppose(std::size_t i, const Off& off) {
    offs_[i] = off;
    solve();
  }

  /// Of the ways in which more of the station may be off than is supposed, the best.
  Gain bestGain(std::size_t i) const {
    Gain best;
    best.value = -1e300;
    for (const Off& off : kWaysOfBeingOff) {
      const bool is_more =
          !(off == offs_[i]) && off.clock >= offs_[i].clock && off.orientation >= offs_[i].orientation;
      if (!is_more) continue;
      const double value = gainOf(i, off);
      if (value > best.value) best = {off, value};
    }
    return best;
  }

  /// By how much the station is off, as is supposed.
  StationCorrection correctionOf(std::size_t i) const {
    StationCorrection correction;
    correction.has_clock = offs_[i].clock;
    correction.has_orientation = offs_[i].orientation;
    Eigen::Vector4d used;
    used << (correction.has_clock ? 1.0 : 0.0),
        Eigen::Vector3d::Constant(correction.has_orientation ? 1.0 : 0.0);
    correction.clock = used(0) * solution_(rowOf(i));
    correction.orientation = used(1) * solution_.segment<3>(rowOf(i) + 1);
    correction.covariance = symmetric(
        used.asDiagonal() * covariance_.block<kStates, kStates>(rowOf(i), rowOf(i)) * used.asDiagonal());
    return correction;
  }

 private:
  Eigen::Index rows() const { return rowOf(size()); }
  static Eigen::Index rowOf(std::size_t i) { return static_cast<Eigen::Index>(kStates * i); }

  Eigen::Vector4d precisionOf(const Off& off) const {
    const double clock = off.clock ? wide_.clock_sigma : normal_.normal_clock_sigma;
    const double angle = off.orientation ? wide_.orientation_sigma : normal_.normal_orientation_sigma;
    Eigen::Vector4d precision;
    precision << 1.0 / (clock * clock), Eigen::Vector3d::Constant(1.0 / (angle * angle));
    return precision;
  }

  void solve() {
    Eigen::VectorXd prior(rows());
    for (std::size_t i = 0; i < size(); ++i) prior.segment<kStates>(rowOf(i)) = precisionOf(offs_[i]);
    const Eigen::VectorXd scale = prior.cwiseSqrt().cwiseInverse();  // all unknowns of the order of one
    Eigen::MatrixXd scaled = scale.asDiagonal() * information_ * scale.asDiagonal();
    scaled.diagonal().array() += 1.0;
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
    covariance_ =
        scale.asDiagonal() * ldlt.solve(Eigen::MatrixXd::Identity(rows(), rows())) * scale.asDiagonal();
    solution_ = covariance_ * vector_;
  }

  /// Log evidence ratio of another prior of one station, all others as they are.
  double gainOf(std::size_t i, const Off& off) const {
    const Eigen::Matrix4d P = covariance_.block<kStates, kStates>(rowOf(i), rowOf(i));
    const Eigen::Vector4d found = solution_.segment<kStates>(rowOf(i));
    const Eigen::Matrix4d W = P.inverse();
    const Eigen::Vector4d b = W * found, before = precisionOf(offs_[i]), after = precisionOf(off);
    Eigen::Matrix4d changed = W;
    changed.diagonal() += after - before;
    return 0.5 * (after.array().log().sum() - before.array().log().sum() - logDeterminant(changed) +
                  logDeterminant(W) + b.dot(changed.llt().solve(b)) - b.dot(found));
  }

  StationCorrectionParams normal_;
  StationAlignmentParams wide_;
  std::vector<int> stations_;
  std::vector<Off> offs_;  // what is supposed, by index of `stations_`
  Eigen::MatrixXd information_;
  Eigen::VectorXd vector_;
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd solution_;
};

/// Log evidence ratio from which a station counts as off by so many standard deviations.
double evidenceOf(double deviations) {
  return 0.5 * deviations * deviations;
}

/// The station that gains most by being off, and how clearly.
struct Suspect {
  std::size_t at = 0;
  Gain gain;
  std::vector<int> doubted;  // stations that count as right, of which one is off as well as another may be
  bool is_clear = false;     // no other station that counts as right explains as much
};

Suspect suspectIn(const Evidence& evidence, double least_margin) {
  std::vector<Gain> gains;
  for (std::size_t i = 0; i < evidence.size(); ++i) gains.push_back(evidence.bestGain(i));
  const auto most = std::max_element(gains.begin(), gains.end(),
                                     [](const Gain& a, const Gain& b) { return a.value < b.value; });
  Suspect suspect;
  suspect.at = static_cast<std::size_t>(most - gains.begin());
  suspect.gain = *most;
  suspect.is_clear = true;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    if (evidence.off(i).any() || suspect.gain.value - gains[i].value >= least_margin) continue;
    suspect.doubted.push_back(evidence.station(i));
    if (i != suspect.at) suspect.is_clear = false;
  }
  return suspect;
}

/// Whether a correction had all that is off in it already.
bool wasOff(const StationCorrection* had, const Off& off) {
  return had && had->has_clock >= off.clock && had->has_orientation >= off.orientation;
}

/// Supposes one station after the other to be off, while that explains more. `before`: what was corrected,
/// which needs less. Returns the stations of which one is off, but nobody can tell which.
std::vector<int> findWrong(Evidence& evidence, const StationCorrectionParams& params,
                           const StationCorrections& before) {
  for (std::size_t wrong = 0;;) {
    const Suspect suspect = suspectIn(evidence, params.least_margin);
    const bool was_off = wasOff(before.of(evidence.station(suspect.at)), suspect.gain.off);
    const double needed = evidenceOf(was_off ? params.release : params.significance);
    if (!(suspect.gain.value >= needed)) return {};
    const bool is_new = !evidence.off(suspect.at).any();
    const bool are_too_many = is_new && 2 * (wrong + 1) >= evidence.size();
    if (are_too_many || (is_new && !suspect.is_clear)) return suspect.doubted;
    if (is_new) ++wrong;
    evidence.suppose(suspect.at, suspect.gain.off);
  }
}

/// Of two stations nobody can tell which is off: both, when one of them is.
std::vector<int> doubtedOfTwo(const Evidence& evidence, double significance) {
  const double most = std::max({0.0, evidence.bestGain(0).value, evidence.bestGain(1).value});
  return most >= evidenceOf(significance) ? evidence.stations() : std::vector<int>{};
}

}  // namespace

Eigen::Matrix<double, 3, 4> alignmentJacobian(const Eigen::Vector3d& direction, const Eigen::Vector3d& rate) {
  Eigen::Matrix<double, 3, 4> A;
  A.col(0) = -rate;                     // stamped late: an older direction
  A.rightCols<3>() = -skew(direction);  // turned: u + theta x u
  return A;
}

Ray corrected(const Ray& ray, const StationCorrection& correction) {  // (P-16)
  const Eigen::Vector3d rate = ray.motion ? ray.motion->rate : Eigen::Vector3d::Zero();
  const auto A = alignmentJacobian(ray.direction, rate);
  Eigen::Vector4d offset;
  offset << correction.clock, correction.orientation;
  Ray right = ray;
  right.direction = (ray.direction - A * offset).normalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - right.direction * right.direction.transpose();
  Eigen::Matrix3d unknown = A * correction.covariance * A.transpose();
  if (ray.motion) unknown += correction.clock * correction.clock * ray.motion->covariance;
  right.covariance = symmetric(across * (ray.covariance + unknown) * across);
  if (right.motion) right.motion->rate = across * (rate - correction.orientation.cross(rate));
  return right;
}

StationCorrections::StationCorrections(const StationCorrectionParams& params,
                                       const StationAlignmentParams& wide)
    : params_(params), wide_(wide) {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("StationCorrectionParams: ") + what + " is required");
  };
  require(params.normal_clock_sigma > 0.0 && params.normal_clock_sigma < wide.clock_sigma,
          "normal_clock_sigma above 0 s and below clock_sigma");
  require(params.normal_orientation_sigma > 0.0 && params.normal_orientation_sigma < wide.orientation_sigma,
          "normal_orientation_sigma above 0 rad and below orientation_sigma");
  require(params.significance > 0.0, "significance > 0");
  require(params.release > 0.0 && params.release < params.significance, "release between 0 and significance");
  require(params.least_margin >= 0.0, "least_margin >= 0");
}

const StationCorrection* StationCorrections::of(int station) const {
  if (station < 0 || station >= static_cast<int>(corrections_.size())) return nullptr;
  const auto& correction = corrections_[static_cast<std::size_t>(station)];
  return correction ? &*correction : nullptr;
}

bool StationCorrections::decide(const StationAlignment& alignment) {  // (P-16)
  undecided_.clear();
  if (!params_.enabled) return false;
  Evidence evidence(params_, wide_, alignment);
  if (evidence.size() > 2) undecided_ = findWrong(evidence, params_, *this);
  if (evidence.size() == 2) undecided_ = doubtedOfTwo(evidence, params_.significance);

  bool is_other = false;
  std::vector<std::optional<StationCorrection>> now(static_cast<std::size_t>(alignment.stations()));
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const Off& off = evidence.off(i);
    const StationCorrection* had = of(evidence.station(i));
    is_other =
        is_other || (had && had->has_clock) != off.clock || (had && had->has_orientation) != off.orientation;
    if (off.any()) now[static_cast<std::size_t>(evidence.station(i))] = evidence.correctionOf(i);
  }
  corrections_ = std::move(now);
  return is_other;
}

}  // namespace sightline::core
