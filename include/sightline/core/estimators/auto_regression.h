#pragma once

#include <optional>

#include <Eigen/Core>

namespace sightline::core {

/// y(j) = a_1 w(j-1) y(j-1) + a_2 w(j-2) y(j-2), fitted to a series: equations (10)-(16C).
struct AutoRegression {
  Eigen::Vector2d a =
      Eigen::Vector2d::Zero();  ///< coefficients of the value before and of the one before that
  Eigen::Matrix2d C_a = Eigen::Matrix2d::Zero();  ///< EFIT^2 (F^T F)^+
  double efit_squared = 0.0;  ///< |y - F a|^2 / (rows - 2), in the unit of the values squared
};

/// Fits the rows of a series by least squares (16C). `value`, oldest first, has two values more than there
/// are rows; `weight` of each value as a regressor (16), all 1 for the unweighted form. Directions of the
/// coefficients that the rows leave open (singular values below 1e-11 of the largest) get zero, as a
/// pseudo-inverse has it. nullopt for fewer than three rows: no degree of freedom would be left for EFIT.
std::optional<AutoRegression> fitAutoRegression(const Eigen::Ref<const Eigen::ArrayXd>& value,
                                                const Eigen::Ref<const Eigen::ArrayXd>& weight);

}  // namespace sightline::core
