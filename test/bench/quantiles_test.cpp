#include "quantiles.h"

#include <cmath>

#include <gtest/gtest.h>

namespace sightline::bench {
namespace {

TEST(Quantile, IsTheValueThatTheShareLiesBelow) {
  std::vector<double> values;
  for (int i = 99; i >= 0; --i) values.push_back(i);
  EXPECT_EQ(quantile(values, 0.0), 0.0);
  EXPECT_EQ(quantile(values, 0.5), 50.0);
  EXPECT_EQ(quantile(values, 0.95), 95.0);
  EXPECT_EQ(quantile(values, 1.0), 99.0);
}

TEST(Quantile, IsNotKnownWithoutValues) {
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Median, IsTheMiddleOrTheUpperOfTwo) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(median({7.0}), 7.0);
}

}  // namespace
}  // namespace sightline::bench
