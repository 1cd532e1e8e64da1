#include "sightline/core/fusion/rules/fusion_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Cholesky>

#include "sightline/core/fusion/rules/intersection_weights.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;
template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

template <typename M>
std::optional<M> inverseOf(const M& positive_definite) {
  const Eigen::LLT<M> factor(positive_definite);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const M inverse = symmetric(factor.solve(M::Identity(positive_definite.rows(), positive_definite.cols())));
  if (!inverse.allFinite()) return std::nullopt;
  return inverse;
}

/// The units a problem is solved in: the component's standard deviation, as the geometric mean over the
/// sources, and the first source's mean as the origin.
template <int N>
struct Units {
  Vector<N> origin;
  Vector<N> sigma;

  static std::optional<Units> of(const std::vector<Estimate<N>>& sources) {
    if (sources.empty()) return std::nullopt;
    Vector<N> logs = Vector<N>::Zero();
    for (const Estimate<N>& source : sources) {
      const Vector<N> variances = source.covariance.diagonal();
      if (!source.mean.allFinite() || !source.covariance.allFinite() || !(variances.array() > 0.0).all()) {
        return std::nullopt;
      }
      logs += 0.5 * variances.array().log().matrix();
    }
    return Units{sources.front().mean, (logs / static_cast<double>(sources.size())).array().exp()};
  }

  Vector<N> inward(const Vector<N>& mean) const { return (mean - origin).cwiseQuotient(sigma); }
  Matrix<N> inward(const Matrix<N>& P) const {
    return symmetric(sigma.cwiseInverse().asDiagonal() * P * sigma.cwiseInverse().asDiagonal());
  }

  FusedEstimate<N> outward(FusedEstimate<N> fused) const {
    fused.mean = origin + sigma.cwiseProduct(fused.mean);
    fused.covariance = symmetric(sigma.asDiagonal() * fused.covariance * sigma.asDiagonal());
    for (Matrix<N>& gain : fused.gains) gain = sigma.asDiagonal() * gain * sigma.cwiseInverse().asDiagonal();
    return fused;
  }
};

/// A problem in its own units.
template <int N>
struct Problem {
  Units<N> units;
  std::vector<Vector<N>> means;
  std::vector<Matrix<N>> covariances;
  std::vector<Matrix<N>> informations;  ///< Y_i = P_i^-1

  static std::optional<Problem> of(const std::vector<Estimate<N>>& sources) {
    const auto units = Units<N>::of(sources);
    if (!units) return std::nullopt;
    Problem problem{*units, {}, {}, {}};
    for (const Estimate<N>& source : sources) {
      const Matrix<N> P = units->inward(source.covariance);
      const auto Y = inverseOf(P);
      if (!Y) return std::nullopt;
      problem.means.push_back(units->inward(source.mean));
      problem.covariances.push_back(P);
      problem.informations.push_back(*Y);
    }
    return problem;
  }

  /// The estimate whose information is `Y`, made of the shares Y_i: x = Y^-1 sum Y_i x_i.
  std::optional<FusedEstimate<N>> fuse(const Matrix<N>& Y, const std::vector<Matrix<N>>& shares) const {
    const auto P = inverseOf(Y);
    if (!P) return std::nullopt;
    FusedEstimate<N> fused{Vector<N>::Zero(), *P, {}};
    for (std::size_t i = 0; i < shares.size(); ++i) {
      fused.gains.push_back(*P * shares[i]);
      fused.mean += fused.gains.back() * means[i];
    }
    return units.outward(std::move(fused));
  }
};

template <int N>
Matrix<N> sumOf(const std::vector<Matrix<N>>& matrices) {
  Matrix<N> sum = Matrix<N>::Zero();
  for (const Matrix<N>& matrix : matrices) sum += matrix;
  return sum;
}

template <int N>
std::optional<FusedEstimate<N>> intersect(const Problem<N>& problem, const Eigen::VectorXd& weights) {
  std::vector<Matrix<N>> shares = problem.informations;
  for (std::size_t i = 0; i < shares.size(); ++i) shares[i] *= weights(static_cast<Eigen::Index>(i));
  return problem.fuse(sumOf<N>(shares), shares);
}

template <int N>
Eigen::VectorXd traceWeights(const std::vector<Estimate<N>>& sources) {
  Eigen::VectorXd traces(static_cast<Eigen::Index>(sources.size()));
  for (std::size_t i = 0; i < sources.size(); ++i)
    traces(static_cast<Eigen::Index>(i)) = sources[i].covariance.trace();
  Eigen::VectorXd weights = traces.cwiseInverse();
  if (!std::isfinite(weights.sum())) weights = traces.minCoeff() * traces.cwiseInverse();
  return weights / weights.sum();
}

bool areWeights(const Eigen::VectorXd& weights) {
  return (weights.array() >= 0.0).all() && std::abs(weights.sum() - 1.0) < 1e-9;
}

template <int N>
std::optional<FusedEstimate<N>> intersectInversely(const Problem<N>& problem, double w) {
  const auto G = inverseOf<Matrix<N>>(w * problem.covariances[0] + (1.0 - w) * problem.covariances[1]);
  if (!G) return std::nullopt;
  const std::vector<Matrix<N>> shares{problem.informations[0] - w * *G,
                                      problem.informations[1] - (1.0 - w) * *G};
  return problem.fuse(sumOf<N>(shares), shares);
}

/// log det of the covariance that inverse intersection gives with weight `w`.
template <int N>
double inverseVolume(const Problem<N>& problem, double w) {
  const auto fused = intersectInversely(problem, w);
  if (!fused) return std::numeric_limits<double>::infinity();
  const Eigen::LLT<Matrix<N>> factor(problem.units.inward(fused->covariance));
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  const Matrix<N> L = factor.matrixL();
  return 2.0 * L.diagonal().array().log().sum();
}

/// The minimum of a function on [low, high], by golden section.
template <typename Function>
double minimise(const Function& function, double low, double high, double tolerance) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = function(left), at_right = function(right);
  while (high - low > tolerance) {
    if (at_left < at_right) {
      high = right, right = left, at_right = at_left;
      left = high - golden * (high - low), at_left = function(left);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + golden * (high - low), at_right = function(right);
    }
  }
  return 0.5 * (low + high);
}

/// The weight of inverse intersection with the least determinant. It is looked for on a grid first, as
/// nothing promises a single minimum; the ends are the sources themselves.
template <int N>
double inverseWeight(const Problem<N>& problem) {
  constexpr int kGrid = 20;
  constexpr double kTie = 1e-12;  // differences of log det that are rounding
  const auto volume = [&problem](double w) { return inverseVolume(problem, w); };
  double best = 0.5, least = volume(0.5);
  for (int k = 0; k <= kGrid; ++k) {
    const double w = static_cast<double>(k) / kGrid;
    const double value = volume(w);
    if (value < least - kTie) best = w, least = value;
  }
  const double refined =
      minimise(volume, std::max(best - 1.0 / kGrid, 0.0), std::min(best + 1.0 / kGrid, 1.0), 1e-7);
  return volume(refined) < least - kTie ? refined : best;
}

}  // namespace

template <int N>
std::optional<FusedEstimate<N>> weightedCovariance(const std::vector<Estimate<N>>& sources) {
  const auto problem = Problem<N>::of(sources);
  if (!problem) return std::nullopt;
  return problem->fuse(sumOf<N>(problem->informations), problem->informations);
}

template <int N>
std::vector<std::optional<Estimate<N>>> weightedCovarianceOfOthers(const std::vector<Estimate<N>>& sources) {
  std::vector<std::optional<Estimate<N>>> others(sources.size());
  if (sources.size() == 2) return {sources[1], sources[0]};  // as they are, so that both differ by the same
  const auto problem = sources.size() > 2 ? Problem<N>::of(sources) : std::nullopt;
  if (!problem) return others;
  // Sums without differences: what comes before a source, and what comes behind it.
  std::vector<Matrix<N>> Y(sources.size(), Matrix<N>::Zero());
  std::vector<Vector<N>> y(sources.size(), Vector<N>::Zero());
  Matrix<N> sum_Y = Matrix<N>::Zero();
  Vector<N> sum_y = Vector<N>::Zero();
  const auto pass = [&](std::size_t i) {
    Y[i] += sum_Y;
    y[i] += sum_y;
    sum_Y += problem->informations[i];
    sum_y += problem->informations[i] * problem->means[i];
  };
  for (std::size_t i = 0; i < sources.size(); ++i) pass(i);
  sum_Y.setZero();
  sum_y.setZero();
  for (std::size_t i = sources.size(); i-- > 0;) pass(i);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto P = inverseOf(Y[i]);
    if (!P) continue;
    const FusedEstimate<N> fused = problem->units.outward({*P * y[i], *P, {}});
    others[i] = Estimate<N>{fused.mean, fused.covariance};
  }
  return others;
}

template <int N>
std::optional<FusedEstimate<N>> barShalomCampo(const Estimate<N>& a, const Estimate<N>& b,
                                               const Eigen::Matrix<double, N, N>& P_ab) {
  const auto units = Units<N>::of({a, b});
  if (!units || !P_ab.allFinite()) return std::nullopt;
  const Matrix<N> P_a = units->inward(a.covariance), P_b = units->inward(b.covariance);
  const Matrix<N> C =
      units->sigma.cwiseInverse().asDiagonal() * P_ab * units->sigma.cwiseInverse().asDiagonal();
  const Eigen::LLT<Matrix<N>> difference(symmetric(P_a + P_b - C - C.transpose()));
  if (difference.info() != Eigen::Success) return std::nullopt;
  const Matrix<N> K =
      difference.solve((P_a - C).transpose()).transpose();  // the gain of b: (P_a - P_ab) D^-1
  FusedEstimate<N> fused;
  fused.mean = units->inward(a.mean) + K * (units->inward(b.mean) - units->inward(a.mean));
  fused.covariance = P_a - K * (P_a - C).transpose();
  fused.gains = {Matrix<N>::Identity() - K, K};
  if (Eigen::LLT<Matrix<N>>(symmetric(fused.covariance)).info() != Eigen::Success) return std::nullopt;
  return units->outward(std::move(fused));
}

template <int N>
std::optional<FusedEstimate<N>> maximumLikelihood(const std::vector<Estimate<N>>& sources,
                                                  const Eigen::MatrixXd& joint) {
  const auto n = static_cast<Eigen::Index>(sources.size());
  if (joint.rows() != n * N || joint.cols() != n * N) {
    throw std::invalid_argument("the joint covariance of " + std::to_string(n) + " sources is " +
                                std::to_string(joint.rows()) + " x " + std::to_string(joint.cols()) +
                                ", not " + std::to_string(n * N) + " square");
  }
  const auto units = Units<N>::of(sources);
  if (!units || !joint.allFinite()) return std::nullopt;
  const Eigen::VectorXd inverse_sigma = units->sigma.cwiseInverse().replicate(n, 1);
  const Eigen::LLT<Eigen::MatrixXd> factor(
      symmetric(inverse_sigma.asDiagonal() * joint * inverse_sigma.asDiagonal()));
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd E = Matrix<N>::Identity().replicate(n, 1);
  const Eigen::MatrixXd weighted = factor.solve(E);  // J^-1 E
  const auto P = inverseOf<Matrix<N>>(symmetric(E.transpose() * weighted));
  if (!P) return std::nullopt;
  FusedEstimate<N> fused{Vector<N>::Zero(), *P, {}};
  for (Eigen::Index i = 0; i < n; ++i) {
    fused.gains.push_back(*P * weighted.middleRows<N>(i * N).transpose());
    fused.mean += fused.gains.back() * units->inward(sources[static_cast<std::size_t>(i)].mean);
  }
  return units->outward(std::move(fused));
}

template <int N>
std::optional<Eigen::VectorXd> intersectionWeights(const std::vector<Estimate<N>>& sources,
                                                   IntersectionWeights criterion) {
  const auto problem = Problem<N>::of(sources);
  if (!problem) return std::nullopt;
  Eigen::VectorXd weights = criterion == IntersectionWeights::trace
                                ? traceWeights(sources)
                                : determinantWeights<N>(problem->informations);
  if (!areWeights(weights)) return std::nullopt;
  return weights;
}

template <int N>
std::optional<FusedEstimate<N>> covarianceIntersection(const std::vector<Estimate<N>>& sources,
                                                       const Eigen::VectorXd& weights) {
  if (weights.size() != static_cast<Eigen::Index>(sources.size()) || !areWeights(weights)) {
    throw std::invalid_argument("covariance intersection needs a weight for each source, >= 0 and of sum 1");
  }
  const auto problem = Problem<N>::of(sources);
  if (!problem) return std::nullopt;
  return intersect(*problem, weights);
}

template <int N>
std::optional<FusedEstimate<N>> covarianceIntersection(const std::vector<Estimate<N>>& sources,
                                                       IntersectionWeights criterion) {
  const auto weights = intersectionWeights(sources, criterion);
  return weights ? covarianceIntersection(sources, *weights) : std::nullopt;
}

template <int N>
std::optional<FusedEstimate<N>> inverseCovarianceIntersection(const Estimate<N>& a, const Estimate<N>& b,
                                                              double w) {
  if (!(w >= 0.0 && w <= 1.0)) throw std::invalid_argument("the weight of inverse intersection is in [0, 1]");
  const auto problem = Problem<N>::of({a, b});
  return problem ? intersectInversely(*problem, w) : std::nullopt;
}

template <int N>
std::optional<FusedEstimate<N>> inverseCovarianceIntersection(const Estimate<N>& a, const Estimate<N>& b) {
  const auto problem = Problem<N>::of({a, b});
  return problem ? intersectInversely(*problem, inverseWeight(*problem)) : std::nullopt;
}

template <int N>
std::optional<FusedEstimate<N>> inverseCovarianceIntersection(const std::vector<Estimate<N>>& sources) {
  const auto problem = Problem<N>::of(sources);
  if (!problem) return std::nullopt;
  std::vector<std::pair<double, std::size_t>> surest_first;  // by the determinant of the covariance
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Matrix<N> L = Eigen::LLT<Matrix<N>>(problem->covariances[i]).matrixL();
    surest_first.emplace_back(L.diagonal().array().log().sum(), i);
  }
  std::stable_sort(surest_first.begin(), surest_first.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  const std::size_t first = surest_first.front().second;
  FusedEstimate<N> fused{sources[first].mean, sources[first].covariance, {}};
  fused.gains.assign(sources.size(), Matrix<N>::Zero());
  fused.gains[first].setIdentity();
  for (std::size_t k = 1; k < surest_first.size(); ++k) {
    const std::size_t next = surest_first[k].second;
    const auto pair = inverseCovarianceIntersection<N>({fused.mean, fused.covariance}, sources[next]);
    if (!pair) return std::nullopt;
    fused.mean = pair->mean;
    fused.covariance = pair->covariance;
    for (Matrix<N>& gain : fused.gains) gain = (pair->gains[0] * gain).eval();
    fused.gains[next] = pair->gains[1];
  }
  return fused;
}

template std::optional<FusedEstimate<2>> weightedCovariance(const std::vector<Estimate<2>>&);
template std::vector<std::optional<Estimate<2>>> weightedCovarianceOfOthers(const std::vector<Estimate<2>>&);
template std::optional<FusedEstimate<2>> barShalomCampo(const Estimate<2>&, const Estimate<2>&,
                                                        const Eigen::Matrix2d&);
template std::optional<FusedEstimate<2>> maximumLikelihood(const std::vector<Estimate<2>>&,
                                                           const Eigen::MatrixXd&);
template std::optional<Eigen::VectorXd> intersectionWeights(const std::vector<Estimate<2>>&,
                                                            IntersectionWeights);
template std::optional<FusedEstimate<2>> covarianceIntersection(const std::vector<Estimate<2>>&,
                                                                const Eigen::VectorXd&);
template std::optional<FusedEstimate<2>> covarianceIntersection(const std::vector<Estimate<2>>&,
                                                                IntersectionWeights);
template std::optional<FusedEstimate<2>> inverseCovarianceIntersection(const Estimate<2>&, const Estimate<2>&,
                                                                       double);
template std::optional<FusedEstimate<2>> inverseCovarianceIntersection(const Estimate<2>&,
                                                                       const Estimate<2>&);
template std::optional<FusedEstimate<2>> inverseCovarianceIntersection(const std::vector<Estimate<2>>&);
template std::optional<FusedEstimate<4>> weightedCovariance(const std::vector<Estimate<4>>&);
template std::vector<std::optional<Estimate<4>>> weightedCovarianceOfOthers(const std::vector<Estimate<4>>&);
template std::optional<FusedEstimate<4>> barShalomCampo(const Estimate<4>&, const Estimate<4>&,
                                                        const Eigen::Matrix4d&);
template std::optional<FusedEstimate<4>> maximumLikelihood(const std::vector<Estimate<4>>&,
                                                           const Eigen::MatrixXd&);
template std::optional<Eigen::VectorXd> intersectionWeights(const std::vector<Estimate<4>>&,
                                                            IntersectionWeights);
template std::optional<FusedEstimate<4>> covarianceIntersection(const std::vector<Estimate<4>>&,
                                                                const Eigen::VectorXd&);
template std::optional<FusedEstimate<4>> covarianceIntersection(const std::vector<Estimate<4>>&,
                                                                IntersectionWeights);
template std::optional<FusedEstimate<4>> inverseCovarianceIntersection(const Estimate<4>&, const Estimate<4>&,
                                                                       double);
template std::optional<FusedEstimate<4>> inverseCovarianceIntersection(const Estimate<4>&,
                                                                       const Estimate<4>&);
template std::optional<FusedEstimate<4>> inverseCovarianceIntersection(const std::vector<Estimate<4>>&);

}  // namespace sightline::core
