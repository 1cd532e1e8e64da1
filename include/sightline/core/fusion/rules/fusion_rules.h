#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

/// What several estimates of one state say together (estimators.md, section 6). All rules take estimates at
/// the same time in the same coordinates, are unbiased when the estimates are, and differ in what they assume
/// of the correlation between the estimates' errors. Every rule answers nullopt when a covariance is not
/// finite or not positive definite. Scales may differ by any factor between the components of the state: each
/// rule computes in units of the sources' own standard deviations. Instantiated for dimensions 2 and 4.
namespace sightline::core {

/// One source's estimate; components and units are the caller's.
template <int N>
struct Estimate {
  Eigen::Matrix<double, N, 1> mean = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Identity();
};

/// What a rule makes of n estimates: mean = sum_i gains[i] mean_i, with sum_i gains[i] = I.
template <int N>
struct FusedEstimate {
  Eigen::Matrix<double, N, 1> mean;
  Eigen::Matrix<double, N, N> covariance;
  std::vector<Eigen::Matrix<double, N, N>> gains;
};

/// The paper's rule: P = (sum P_i^-1)^-1, x = P sum P_i^-1 x_i. It assumes independent errors; where they are
/// correlated its covariance is too small. P <= P_i for every source (Loewner order).
template <int N>
std::optional<FusedEstimate<N>> weightedCovariance(const std::vector<Estimate<N>>& sources);

/// For each source the same of all others, where that is determined; nothing for a single source. In the time
/// that a few fusions take.
template <int N>
std::vector<std::optional<Estimate<N>>> weightedCovarianceOfOthers(const std::vector<Estimate<N>>& sources);

/// Bar-Shalom and Campo's rule for two sources with cross-covariance P_ab = cov(error_a, error_b). P <= P_a
/// and P <= P_b. nullopt also when P_a + P_b - P_ab - P_ab^T is not positive definite.
template <int N>
std::optional<FusedEstimate<N>> barShalomCampo(const Estimate<N>& a, const Estimate<N>& b,
                                               const Eigen::Matrix<double, N, N>& P_ab);

/// Maximum likelihood for n sources with all cross-covariances: x = (E^T J^-1 E)^-1 E^T J^-1 X, where E
/// stacks n identity matrices and J is the `joint` covariance (nN x nN) whose blocks are P_ij; its diagonal
/// blocks stand for the sources' covariances. P <= P_i. Equal to Bar-Shalom and Campo's for two sources. A
/// joint matrix of another size throws std::invalid_argument.
template <int N>
std::optional<FusedEstimate<N>> maximumLikelihood(const std::vector<Estimate<N>>& sources,
                                                  const Eigen::MatrixXd& joint);

/// What the weights of covariance intersection minimise.
enum class IntersectionWeights {
  determinant,  ///< log det P, a convex problem: no unit matters; det P <= det P_i. A clearly better source
                ///< gets all
  trace,        ///< proportional to 1 / tr P_i: no optimum, but every source has its share; units matter
};

/// Weights of covariance intersection, one for each source, >= 0, sum 1; nullopt also where rounding leaves
/// none. Sources with equal covariances get equal weights. The determinant's are within 1e-8 of the optimum
/// of log det P.
template <int N>
std::optional<Eigen::VectorXd> intersectionWeights(const std::vector<Estimate<N>>& sources,
                                                   IntersectionWeights criterion);

/// Covariance intersection: P = (sum w_i P_i^-1)^-1, x = P sum w_i P_i^-1 x_i. Consistent whatever the
/// correlation between the sources' errors is, and therefore larger than the others. P <= sum w_i P_i.
/// Weights of another number, negative, or not of sum 1 (within 1e-9) throw std::invalid_argument.
template <int N>
std::optional<FusedEstimate<N>> covarianceIntersection(const std::vector<Estimate<N>>& sources,
                                                       const Eigen::VectorXd& weights);

/// The same with weights after `criterion`.
template <int N>
std::optional<FusedEstimate<N>> covarianceIntersection(const std::vector<Estimate<N>>& sources,
                                                       IntersectionWeights criterion);

/// Inverse covariance intersection for two sources (B. Noack et al., Automatica 79, 2017):
/// P = (P_a^-1 + P_b^-1 - (w P_a + (1-w) P_b)^-1)^-1, for sources that hold some information in common; `w`
/// in [0, 1]. P <= that of covariance intersection with weights (1-w, w). Weights outside throw
/// std::invalid_argument.
template <int N>
std::optional<FusedEstimate<N>> inverseCovarianceIntersection(const Estimate<N>& a, const Estimate<N>& b,
                                                              double w);

/// The same with the weight that minimises det P, to 1e-6; equal covariances get 1/2. det P <= det P_a, det
/// P_b.
template <int N>
std::optional<FusedEstimate<N>> inverseCovarianceIntersection(const Estimate<N>& a, const Estimate<N>& b);

/// The same for any number of sources: the surest first, one after the other is taken in.
template <int N>
std::optional<FusedEstimate<N>> inverseCovarianceIntersection(const std::vector<Estimate<N>>& sources);

}  // namespace sightline::core
