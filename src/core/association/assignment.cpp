#include "sightline/core/association/assignment.h"

#include <algorithm>
#include <cmath>

namespace sightline::core {
namespace {

constexpr double kLargestCost = 1e100;  // in size: sums and differences of such costs stay finite

bool isAllowed(double cost) {
  return std::abs(cost) <= kLargestCost;  // not for NaN
}

/// The problem with one private extra column for every row, which stands for "alone": it always has a
/// solution.
class CompletedCost {
 public:
  CompletedCost(const Eigen::MatrixXd& cost, double cost_alone) : cost_(cost), cost_alone_(cost_alone) {}

  int rows() const { return static_cast<int>(cost_.rows()); }
  int columns() const { return static_cast<int>(cost_.cols() + cost_.rows()); }
  double operator()(int row, int column) const {
    if (column < cost_.cols()) return isAllowed(cost_(row, column)) ? cost_(row, column) : kForbidden;
    return column - cost_.cols() == row ? cost_alone_ : kForbidden;
  }

 private:
  const Eigen::MatrixXd& cost_;
  double cost_alone_;
};

/// A price of staying alone that no exchange of pairs can outweigh.
double prohibitiveCost(const Eigen::MatrixXd& cost) {
  double largest = 0.0;
  for (Eigen::Index k = 0; k < cost.size(); ++k) {
    const double value = *(cost.data() + k);
    if (isAllowed(value)) largest = std::max(largest, std::abs(value));
  }
  return 1.0 + 2.0 * largest * static_cast<double>(std::min(cost.rows(), cost.cols()) + 1);
}

/// The matching while it grows: duals of rows and columns, and the row of every column (-1 = free).
struct Matching {
  std::vector<double> row_dual, column_dual;
  std::vector<int> row_of;
};

/// Matches one more row along the shortest augmenting path (Dijkstra on reduced costs).
void augment(const CompletedCost& cost, int new_row, Matching& matching) {
  const int columns = cost.columns();
  std::vector<double> distance(columns, kForbidden);
  std::vector<int> previous(columns, -1);
  std::vector<bool> settled(columns, false);

  int row = new_row, column = -1;
  double length = 0.0;
  std::vector<int> path;  // settled columns in order
  while (row >= 0) {
    int nearest = -1;
    for (int j = 0; j < columns; ++j) {
      if (settled[j]) continue;
      const double through = length + cost(row, j) - matching.row_dual[row] - matching.column_dual[j];
      if (through < distance[j]) {
        distance[j] = through;
        previous[j] = column;
      }
      if (nearest < 0 || distance[j] < distance[nearest]) nearest = j;
    }
    column = nearest;
    settled[column] = true;
    path.push_back(column);
    length = distance[column];
    row = matching.row_of[column];
  }

  matching.row_dual[new_row] += length;
  for (const int j : path) {
    const double slack = length - distance[j];
    if (matching.row_of[j] >= 0) matching.row_dual[matching.row_of[j]] += slack;
    matching.column_dual[j] -= slack;
  }
  for (; previous[column] >= 0; column = previous[column])
    matching.row_of[column] = matching.row_of[previous[column]];
  matching.row_of[column] = new_row;
}

}  // namespace

std::vector<int> assign(const Eigen::MatrixXd& cost, double cost_alone) {
  const CompletedCost completed(cost, isAllowed(cost_alone) ? cost_alone : prohibitiveCost(cost));
  Matching matching{std::vector<double>(completed.rows(), 0.0), std::vector<double>(completed.columns(), 0.0),
                    std::vector<int>(completed.columns(), -1)};
  for (int row = 0; row < completed.rows(); ++row) augment(completed, row, matching);

  std::vector<int> column_of(completed.rows(), -1);
  for (int column = 0; column < static_cast<int>(cost.cols()); ++column) {
    if (matching.row_of[column] >= 0) column_of[matching.row_of[column]] = column;
  }
  return column_of;
}

}  // namespace sightline::core
