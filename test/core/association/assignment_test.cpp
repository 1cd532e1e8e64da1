#include "sightline/core/association/assignment.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

double costOf(const Eigen::MatrixXd& cost, const std::vector<int>& columns, double alone) {
  double sum = 0.0;
  for (std::size_t row = 0; row < columns.size(); ++row) {
    sum += columns[row] < 0 ? alone : cost(static_cast<Eigen::Index>(row), columns[row]);
  }
  return sum;
}

/// The best over every way, by trying them all.
double bestByEnumeration(const Eigen::MatrixXd& cost, double alone) {
  std::vector<bool> taken(static_cast<std::size_t>(cost.cols()), false);
  std::function<double(Eigen::Index)> best = [&](Eigen::Index row) {
    if (row == cost.rows()) return 0.0;
    double least = alone + best(row + 1);
    for (Eigen::Index column = 0; column < cost.cols(); ++column) {
      if (taken[column] || std::isinf(cost(row, column))) continue;
      taken[column] = true;
      least = std::min(least, cost(row, column) + best(row + 1));
      taken[column] = false;
    }
    return least;
  };
  return best(0);
}

TEST(Assignment, GreedyWouldBeWrongHere) {
  Eigen::Matrix2d cost;
  cost << 1.0, 2.0,  //
      1.1, 10.0;
  EXPECT_EQ(assign(cost), (std::vector<int>{1, 0}));
}

TEST(Assignment, ForbiddenPairsAreNeverMade) {
  Eigen::MatrixXd cost(2, 2);
  cost << 1.0, kForbidden,  //
      0.5, kForbidden;
  EXPECT_EQ(assign(cost), (std::vector<int>{-1, 0}));
}

TEST(Assignment, AsManyRowsAsPossibleAreAssignedWhenAloneIsInfinite) {
  Eigen::MatrixXd cost(2, 2);
  cost << 1.0, 1e6,  //
      1.0, kForbidden;
  EXPECT_EQ(assign(cost), (std::vector<int>{1, 0}));
}

TEST(Assignment, RowStaysAloneWhenThatIsCheaper) {
  Eigen::MatrixXd cost(1, 1);
  cost << 5.0;
  EXPECT_EQ(assign(cost, 4.0), (std::vector<int>{-1}));
  EXPECT_EQ(assign(cost, 6.0), (std::vector<int>{0}));
}

TEST(Assignment, EmptyProblemsHaveEmptyAnswers) {
  EXPECT_TRUE(assign(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(assign(Eigen::MatrixXd(2, 0)), (std::vector<int>{-1, -1}));
}

TEST(Assignment, ACostThatIsNoNumberOrAbsurdForbidsItsPair) {
  for (const double odd : {std::nan(""), -kForbidden, 1e300, -1e300, 1e101}) {
    Eigen::MatrixXd cost(2, 2);
    cost << odd, 1.0,  //
        3.0, odd;
    EXPECT_EQ(assign(cost), (std::vector<int>{1, 0})) << odd;
    EXPECT_EQ(assign(cost, 2.0), (std::vector<int>{1, -1})) << odd;
    EXPECT_EQ(assign(cost, odd), (std::vector<int>{1, 0})) << "alone at " << odd;
    cost.setConstant(odd);
    EXPECT_EQ(assign(cost), (std::vector<int>{-1, -1})) << odd;
  }
}

TEST(Assignment, LargeCostsThatAreAllowedAreCompared) {
  Eigen::MatrixXd cost(2, 2);
  cost << 1e99, 2e99,  //
      1e99, 4e99;
  EXPECT_EQ(assign(cost), (std::vector<int>{1, 0}));
}

TEST(Assignment, EqualsExhaustiveSearchOnRandomRectangularProblems) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::uniform_int_distribution<int> size(1, 6);
  for (int trial = 0; trial < 2000; ++trial) {
    Eigen::MatrixXd cost(size(random), size(random));
    for (Eigen::Index k = 0; k < cost.size(); ++k) {
      *(cost.data() + k) = uniform(random) < -0.5 ? kForbidden : uniform(random);
    }
    const double alone = trial % 2 ? 0.3 : 50.0;
    const std::vector<int> columns = assign(cost, alone);
    for (std::size_t row = 0; row < columns.size(); ++row) {
      const auto takers = std::count(columns.begin(), columns.end(), columns[row]);
      EXPECT_TRUE(columns[row] < 0 || takers == 1);
    }
    ASSERT_NEAR(costOf(cost, columns, alone), bestByEnumeration(cost, alone), 1e-12) << cost;
  }
}

}  // namespace
}  // namespace sightline::core
