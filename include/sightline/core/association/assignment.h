#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

namespace sightline::core {

/// Cost of a pair that must not be made.
constexpr double kForbidden = std::numeric_limits<double>::infinity();

/// Optimal assignment of rows to columns: each row to at most one column, each column to at most one row,
/// with the smallest sum of costs. A pair is forbidden by `kForbidden`, and by any cost that is not a number
/// of at most 1e100 in size. A row may stay alone at `cost_alone`; when that is no such number (the default),
/// as many rows as possible are assigned, and among those ways the cheapest is taken.
///
/// Returns for each row its column, or -1. Deterministic; O(rows^2 (rows + columns)) by shortest augmenting
/// paths (R. Jonker and A. Volgenant, Computing 38, 1987). Costs of any sign. Never throws for
/// what is in them.
std::vector<int> assign(const Eigen::MatrixXd& cost, double cost_alone = kForbidden);

}  // namespace sightline::core
