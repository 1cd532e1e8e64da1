#pragma once

#include <vector>

#include <Eigen/Core>

#include "sightline/core/evaluation/gospa.h"

namespace sightline::core {

/// How far a set of directions is from the true one, a member of the larger set:
/// distance^p = localisation^p + cardinality^p. All [rad], in [0, c].
struct Ospa {
  double distance = 0.0;
  double localisation = 0.0;  ///< of the pairs, those further apart than c counted as c apart
  double cardinality = 0.0;   ///< of the members that one set has more than the other
};

/// Optimal sub-pattern assignment metric of order p and cutoff c (`params`) between sets of unit vectors; the
/// distance of a pair is the angle between them (D. Schuhmacher, B.-T. Vo, B.-N. Vo, IEEE Trans. Signal
/// Processing 56, 2008). Two empty sets are at distance 0.
Ospa ospa(const std::vector<Eigen::Vector3d>& estimates, const std::vector<Eigen::Vector3d>& truths,
          const GospaParams& params = {});

/// The same of two sets whose GOSPA by the same parameters is known: both have the same best assignment, as
/// n OSPA^p = GOSPA^p + c^p (n - m) / 2 for sets of m <= n members.
Ospa ospa(const Gospa& gospa, const GospaParams& params);

}  // namespace sightline::core
