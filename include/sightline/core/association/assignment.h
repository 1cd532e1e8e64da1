#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

namespace sightline::core {

/// Optimal assignment of rows to columns: each row to at most one column, each column to at most one row,
/// with the smallest sum of costs. An infinite cost forbids a pair. A row may stay alone at `cost_alone`;
/// when that is infinite (the default), as many rows as possible are assigned, and among those ways the
/// cheapest is taken.
///
/// Returns for each row its column, or -1. Deterministic; O(rows^2 (rows + columns)) by shortest augmenting
/// paths (R. Jonker and A. Volgenant, Computing 38, 1987). Costs of any sign; NaN throws
/// std::invalid_argument.
std::vector<int> assign(const Eigen::MatrixXd& cost,
                        double cost_alone = std::numeric_limits<double>::infinity());

}  // namespace sightline::core
