#include "sightline/core/estimators/auto_regression.h"

#include <cmath>

namespace sightline::core {
namespace {

constexpr double kLeastSingularValue = 1e-11;  // of the largest

/// Pseudo-inverse of the upper triangular R = [[r11, r12], [0, r22]].
Eigen::Matrix2d pseudoInverse(double r11, double r12, double r22) {
  Eigen::Matrix2d R;
  R << r11, r12, 0.0, r22;
  const double square = R.squaredNorm(), det = r11 * r22;
  if (square == 0.0) return Eigen::Matrix2d::Zero();
  const double largest =
      std::sqrt(0.5 * (square + std::sqrt(std::max(0.0, square * square - 4.0 * det * det))));
  if (std::abs(det) > kLeastSingularValue * largest * largest) {
    Eigen::Matrix2d inverse;
    inverse << r22, -r12, 0.0, r11;
    return inverse / det;
  }
  return R.transpose() / square;  // rank one: the transpose over the one singular value squared
}

}  // namespace

std::optional<AutoRegression> fitAutoRegression(const Eigen::Ref<const Eigen::ArrayXd>& value,
                                                const Eigen::Ref<const Eigen::ArrayXd>& weight) {  // (16C)
  const Eigen::Index rows = value.size() - 2;
  if (rows < 3) return std::nullopt;
  const auto regressor = [&](Eigen::Index i) { return weight(i) * value(i); };

  // F = Q R by Gram-Schmidt on the two columns: the normal equations would square the condition, and
  // neighbouring values of a fine sensor are nearly equal.
  double r11 = 0.0, c12 = 0.0, c1y = 0.0;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double c1 = regressor(row + 1);
    r11 += c1 * c1;
    c12 += c1 * regressor(row);
    c1y += c1 * value(row + 2);
  }
  const double along = r11 > 0.0 ? c12 / r11 : 0.0, along_y = r11 > 0.0 ? c1y / r11 : 0.0;
  double r22 = 0.0, c2y = 0.0;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double c1 = regressor(row + 1), c2 = regressor(row) - along * c1;
    r22 += c2 * c2;
    c2y += c2 * (value(row + 2) - along_y * c1);
  }
  r11 = std::sqrt(r11);
  r22 = std::sqrt(r22);
  const Eigen::Matrix2d R_inverse = pseudoInverse(r11, along * r11, r22);

  AutoRegression fit;
  fit.a = R_inverse * Eigen::Vector2d(along_y * r11, r22 > 0.0 ? c2y / r22 : 0.0);  // (16C)
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double e = value(row + 2) - fit.a(0) * regressor(row + 1) - fit.a(1) * regressor(row);
    fit.efit_squared += e * e;
  }
  fit.efit_squared /= static_cast<double>(rows - 2);
  fit.C_a = fit.efit_squared * R_inverse * R_inverse.transpose();
  return fit;
}

}  // namespace sightline::core
