#include "sightline/core/positions/stations/station_correction.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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
  std::vector<int> known;
  for (int station = 0; station < alignment.stations(); ++station)
    if (alignment.knows(station)) known.push_back(station);
  const std::size_t n = known.size();
  const auto size = static_cast<Eigen::Index>(kStates * n);
  Eigen::MatrixXd information(size, size);
  Eigen::VectorXd vector(size);
  const StationAlignment::Equations equations = n > 0 ? alignment.equations() : StationAlignment::Equations{};
  for (std::size_t i = 0; i < n; ++i) {
    const auto at_i = static_cast<Eigen::Index>(kStates * i);
    vector.segment<kStates>(at_i) = equations.vector.segment<kStates>(kStates * known[i]);
    for (std::size_t j = 0; j < n; ++j)
      information.block<kStates, kStates>(at_i, static_cast<Eigen::Index>(kStates * j)) =
          equations.information.block<kStates, kStates>(kStates * known[i], kStates * known[j]);
  }
  const auto priorOf = [&](const Off& off) {
    Eigen::Vector4d precision;
    const double clock = off.clock ? wide_.clock_sigma : params_.normal_clock_sigma;
    const double angle = off.orientation ? wide_.orientation_sigma : params_.normal_orientation_sigma;
    precision << 1.0 / (clock * clock), Eigen::Vector3d::Constant(1.0 / (angle * angle));
    return precision;
  };
  std::vector<Off> offs(n, Off{true, true});
  Eigen::MatrixXd covariance;
  Eigen::VectorXd solution;
  const auto solve = [&]() {
    Eigen::VectorXd prior(size);
    for (std::size_t i = 0; i < n; ++i)
      prior.segment<kStates>(static_cast<Eigen::Index>(kStates * i)) = priorOf(offs[i]);
    const Eigen::VectorXd scale = prior.cwiseSqrt().cwiseInverse();  // all unknowns of the order of one
    Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    scaled.diagonal().array() += 1.0;
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
    covariance = scale.asDiagonal() * ldlt.solve(Eigen::MatrixXd::Identity(size, size)) * scale.asDiagonal();
    solution = covariance * vector;
  };
  std::fill(offs.begin(), offs.end(), Off{});

  // Evidence for another prior of one station, all others as they are.
  const auto gainOf = [&](std::size_t i, const Off& off) {
    const auto at = static_cast<Eigen::Index>(kStates * i);
    const Eigen::Matrix4d P = covariance.block<kStates, kStates>(at, at);
    const Eigen::Matrix4d W = P.inverse();
    const Eigen::Vector4d b = W * solution.segment<kStates>(at), before = priorOf(offs[i]),
                          after = priorOf(off);
    Eigen::Matrix4d changed = W;
    changed.diagonal() += after - before;
    return 0.5 * (after.array().log().sum() - before.array().log().sum() - logDeterminant(changed) +
                  logDeterminant(W) + b.dot(changed.llt().solve(b)) - b.dot(solution.segment<kStates>(at)));
  };
  const double on = 0.5 * params_.significance * params_.significance,
               off_below = 0.5 * params_.release * params_.release;
  for (std::size_t wrong = 0; n > 2;) {
    solve();
    std::vector<Gain> gains(n);
    for (std::size_t i = 0; i < n; ++i) {
      gains[i].value = -1e300;
      for (const Off off : {Off{true, false}, Off{false, true}, Off{true, true}}) {
        const bool is_more =
            !(off == offs[i]) && off.clock >= offs[i].clock && off.orientation >= offs[i].orientation;
        if (!is_more) continue;
        const double value = gainOf(i, off);
        if (value > gains[i].value) gains[i] = {off, value};
      }
    }
    std::size_t best = 0, second = n;
    for (std::size_t i = 1; i < n; ++i)
      if (gains[i].value > gains[best].value) best = i;
    for (std::size_t i = 0; i < n; ++i)
      if (i != best && !offs[i].any() && (second == n || gains[i].value > gains[second].value)) second = i;
    const StationCorrection* had = of(known[best]);
    const bool was_off =
        had && had->has_clock >= gains[best].off.clock && had->has_orientation >= gains[best].off.orientation;
    if (!(gains[best].value >= (was_off ? off_below : on))) break;
    const bool is_clear = second == n || gains[best].value - gains[second].value >= params_.least_margin;
    const bool is_new = !offs[best].any();
    if (is_new && (!is_clear || 2 * (wrong + 1) >= n)) {
      for (std::size_t i = 0; i < n; ++i)
        if (!offs[i].any() && gains[best].value - gains[i].value < params_.least_margin)
          undecided_.push_back(known[i]);
      break;
    }
    if (is_new) ++wrong;
    offs[best] = gains[best].off;
  }
  if (n == 2) {
    solve();
    double most = 0.0;
    for (const Off off : {Off{true, false}, Off{false, true}, Off{true, true}})
      most = std::max({most, gainOf(0, off), gainOf(1, off)});
    if (most >= on) undecided_ = known;
  }
  if (n > 2) solve();

  bool is_other = false;
  std::vector<std::optional<StationCorrection>> now(static_cast<std::size_t>(alignment.stations()));
  for (std::size_t i = 0; i < n; ++i) {
    const StationCorrection* had = of(known[i]);
    is_other = is_other || (had && had->has_clock) != offs[i].clock ||
               (had && had->has_orientation) != offs[i].orientation;
    if (!offs[i].any()) continue;
    const auto at = static_cast<Eigen::Index>(kStates * i);
    Eigen::Vector4d used;
    used << (offs[i].clock ? 1.0 : 0.0), Eigen::Vector3d::Constant(offs[i].orientation ? 1.0 : 0.0);
    StationCorrection correction;
    correction.has_clock = offs[i].clock;
    correction.has_orientation = offs[i].orientation;
    correction.clock = used(0) * solution(at);
    correction.orientation = used(1) * solution.segment<3>(at + 1);
    correction.covariance =
        symmetric(used.asDiagonal() * covariance.block<kStates, kStates>(at, at) * used.asDiagonal());
    now[static_cast<std::size_t>(known[i])] = correction;
  }
  corrections_ = std::move(now);
  return is_other;
}

}  // namespace sightline::core
