#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "support/paths.h"

/// The vectors of golden.json, which not everybody has.
namespace sightline::test {

inline YAML::Node golden(const std::string& name) {
  return YAML::LoadFile(sharedDirectory() + "/design/golden.json")[name];
}

inline Eigen::ArrayXd array(const YAML::Node& node) {
  Eigen::ArrayXd values(static_cast<Eigen::Index>(node.size()));
  for (std::size_t i = 0; i < node.size(); ++i) values(static_cast<Eigen::Index>(i)) = node[i].as<double>();
  return values;
}

inline Eigen::MatrixXd matrix(const YAML::Node& node) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(node.size()), static_cast<Eigen::Index>(node[0].size()));
  for (std::size_t i = 0; i < node.size(); ++i)
    values.row(static_cast<Eigen::Index>(i)) = array(node[i]).matrix().transpose();
  return values;
}

/// Agreement to 1e-9, relative to the larger of 1 and the size of the expected value's array.
inline void expectGolden(const Eigen::MatrixXd& value, const Eigen::MatrixXd& expected) {
  ASSERT_EQ(value.rows(), expected.rows());
  ASSERT_EQ(value.cols(), expected.cols());
  EXPECT_LT((value - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.cwiseAbs().maxCoeff())
      << value << "\nexpected\n"
      << expected;
}

}  // namespace sightline::test

/// Skips the running test, visibly, where the golden vectors are not at hand.
#define SIGHTLINE_REQUIRE_SHARED() \
  if (sightline::test::sharedDirectory().empty()) GTEST_SKIP() << "needs ../shared (SIGHTLINE_SHARED_DIR)"
