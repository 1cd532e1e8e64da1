#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/evaluation/metrics.h"

namespace sightline::core {

struct GospaParams {
  double cutoff =
      0.01;            ///< c [rad]: an estimate further away than this is a false one, its target missed; > 0
  double order = 2.0;  ///< p, >= 1
};

/// How far a set of directions is from the true one, and why:
/// distance^p = localisation^p + (missed + extra) c^p / 2.
struct Gospa {
  double distance = 0.0;      ///< [rad]
  double localisation = 0.0;  ///< (sum of d^p over the assigned pairs)^(1/p) [rad]
  int assigned = 0;           ///< pairs
  int missed = 0;             ///< targets without an estimate
  int extra = 0;              ///< estimates without a target
};

/// Generalised optimal sub-pattern assignment metric with alpha = 2 between two sets (A. S. Rahmathullah,
/// A. F. Garcia-Fernandez, L. Svensson, FUSION 2017). `distances`: of estimates (rows) and truths (columns),
/// in the unit of the cutoff; those beyond the cutoff may be infinite.
Gospa gospaOfDistances(const Eigen::MatrixXd& distances, const GospaParams& params);

/// The same of sets of unit vectors; the distance of a pair is the angle between them.
Gospa gospa(const std::vector<Eigen::Vector3d>& estimates, const std::vector<Eigen::Vector3d>& truths,
            const GospaParams& params = {});

/// Means over instants that come one by one; NaN without any. Of the parts as costs, each is the share of one
/// cause in the mean metric: rms^p = localisationCost^p + missedCost^p + extraCost^p.
class GospaMeans {
 public:
  GospaMeans() = default;
  explicit GospaMeans(const GospaParams& params) : params_(params) {}

  /// The metric of one instant, by the same parameters.
  void add(const Gospa& gospa);

  const GospaParams& params() const { return params_; }
  std::uint64_t instants() const { return distance_.count(); }
  double distance() const { return distance_.mean(); }  ///< [rad]
  double localisation() const;                          ///< (mean of d^p over all assigned pairs)^(1/p) [rad]
  double missed() const { return missed_.mean(); }      ///< targets without an estimate, an instant
  double extra() const { return extra_.mean(); }        ///< estimates without a target, an instant

  double rms() const;               ///< (mean of distance^p)^(1/p) [rad]
  double localisationCost() const;  ///< (mean of localisation^p over instants)^(1/p) [rad]
  double missedCost() const;        ///< (mean of missed c^p / 2)^(1/p) [rad]
  double extraCost() const;         ///< (mean of extra c^p / 2)^(1/p) [rad]

 private:
  double costOf(double count) const;  // of so many members without a partner [rad]

  GospaParams params_;
  RunningMean distance_, missed_, extra_;
  RunningMean pairs_;  // sum of d^p over an instant's pairs
  std::uint64_t assigned_ = 0;
};

}  // namespace sightline::core
