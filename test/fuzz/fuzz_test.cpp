// A bounded number of cases of the fuzz program, always the same ones. To go on from there: scripts/fuzz.
#include <cmath>
#include <console_bridge/console.h>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <ros/console.h>
#include <ros/time.h>

#include "fuzz/fuzz_driver.h"
#include "fuzz/ros/ros_targets.h"

namespace {

using namespace sightline_fuzz;

class FuzzTargets : public testing::TestWithParam<FuzzTarget> {
 protected:
  static void SetUpTestSuite() {
    ros::Time::init();
    ros::console::set_logger_level(ROSCONSOLE_DEFAULT_NAME, ros::console::levels::Fatal);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  }
};

TEST_P(FuzzTargets, KeepTheirPromisesInTheFirstCases) {
  const FuzzTarget& target = GetParam();
  Tally tally;
  for (std::uint64_t number = 1; number <= 40; ++number) {
    const auto fault = runCase(target, number, tally);
    EXPECT_FALSE(fault) << target.name << " --case " << number << ": " << *fault;
  }
  EXPECT_GT(tally.calls, 40u);
}

INSTANTIATE_TEST_SUITE_P(Core, FuzzTargets, testing::ValuesIn(coreTargets()),
                         [](const testing::TestParamInfo<FuzzTarget>& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(Ros, FuzzTargets, testing::ValuesIn(rosTargets()),
                         [](const testing::TestParamInfo<FuzzTarget>& info) { return info.param.name; });

/// The corpus: a change of what a target draws makes other cases of them, which must hold as well.
TEST(Fuzz, CasesThatOnceShowedAFaultShowNone) {
  const std::vector<std::pair<std::string, std::vector<std::uint64_t>>> found{
      {"local_tracker", {3, 11, 55, 58, 76, 84, 96, 140, 1073, 1201}},
      {"arrival_order", {6, 21, 42, 1080}},
      {"track_fusion", {4, 38, 45, 83, 130, 198, 200, 402}},
      {"fused_trackers", {12, 13, 29, 60, 150}},
      {"position_tracker", {70}}};
  Tally tally;
  for (const auto& [name, numbers] : found) {
    for (const FuzzTarget& target : coreTargets()) {
      if (target.name != name) continue;
      for (const std::uint64_t number : numbers) {
        const auto fault = runCase(target, number, tally);
        EXPECT_FALSE(fault) << name << " --case " << number << ": " << *fault;
      }
    }
  }
  EXPECT_EQ(28u, tally.cases);
}

TEST(Fuzz, AFaultIsFoundAndNamed) {
  const FuzzTarget faulty{"faulty", "throws", [](RandomInput&, Trial& trial) {
                            trial.call("fine", [] {});
                            trial.call("door", [] { throw std::out_of_range("beyond"); });
                          }};
  Tally tally;
  EXPECT_EQ("call 2: door threw: beyond", runCase(faulty, 1, tally).value_or(""));
  EXPECT_EQ(1u, tally.faults);
}

TEST(Fuzz, TheSameNumberIsTheSameCase) {
  RandomInput a(7), b(7), c(8);
  const std::uint64_t first = a.bits();
  EXPECT_EQ(first, b.bits());
  EXPECT_NE(first, c.bits());
}

TEST(Fuzz, CovariancesThatAreNoneAreFound) {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  requireCovariance(covariance, "unit");
  covariance << 1.0, 1e-20, 0.0, 1.0;
  EXPECT_THROW(requireCovariance(covariance, "lopsided"), Fault);
  covariance << 1.0, 2.0, 2.0, 1.0;
  EXPECT_THROW(requireCovariance(covariance, "indefinite"), Fault);
  covariance << 1e-30, 2e-15, 2e-15, 1.0;
  EXPECT_THROW(requireCovariance(covariance, "indefinite in its own units"), Fault);
  covariance << 1.0, 0.0, 0.0, std::nan("");
  EXPECT_THROW(requireCovariance(covariance, "not a number"), Fault);
}

}  // namespace
