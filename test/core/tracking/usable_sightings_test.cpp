#include "sightline/core/tracking/usable_sightings.h"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

Sighting good(double azimuth) {
  return sightingOf({azimuth, 0.0}, 1e-6 * Eigen::Matrix2d::Identity());
}

Scan scanOf(const std::vector<Sighting>& sightings) {
  Scan scan;
  scan.sensor = "eye";
  scan.sightings = sightings;
  return scan;
}

TEST(UsableSightings, ThoseWithoutUsableNumbersAreRejectedOneByOneWithTheirReason) {
  Sighting no_unit = good(0.1), not_finite = good(0.2), no_covariance = good(0.3);
  no_unit.direction *= 1.1;
  not_finite.covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  no_covariance.covariance.setZero();
  const UsableSightings usable =
      usableSightings(scanOf({no_unit, good(0.5), not_finite, no_covariance, good(0.6)}), 10);
  EXPECT_EQ(usable.scan.sensor, "eye");
  EXPECT_EQ(usable.place, (std::vector<std::size_t>{1, 4}));
  ASSERT_EQ(usable.scan.sightings.size(), 2u);
  EXPECT_EQ(usable.scan.sightings[1].direction, good(0.6).direction);
  ASSERT_EQ(usable.decisions.size(), 5u);
  for (const std::size_t j : {0u, 2u, 3u}) {
    EXPECT_EQ(usable.decisions[j].sighting, j);
    EXPECT_EQ(usable.decisions[j].decision, Decision::rejected_input);
    EXPECT_NE(usable.decisions[j].reason, "");
  }
}

TEST(UsableSightings, ThoseBeyondTheMostAreRejectedAndTheReasonNamesTheParameter) {
  const UsableSightings usable = usableSightings(scanOf({good(0.1), good(0.2), good(0.3)}), 2);
  EXPECT_EQ(usable.scan.sightings.size(), 2u);
  EXPECT_NE(usable.decisions[2].reason.find("max_sightings 2"), std::string::npos);
}

TEST(UsableSightings, DecisionsAreEnteredAtThePlacesOfTheOriginalScan) {
  Sighting bad = good(0.1);
  bad.direction.setZero();
  UsableSightings usable = usableSightings(scanOf({bad, good(0.2), good(0.3)}), 10);
  std::vector<Association> made(2);
  made[0].decision = Decision::accepted;
  made[0].track = 5;
  made[1].sighting = 1;
  made[1].decision = Decision::started_track;
  usable.enter(made);
  EXPECT_EQ(usable.decisions[0].decision, Decision::rejected_input);
  EXPECT_EQ(usable.decisions[1].decision, Decision::accepted);
  EXPECT_EQ(usable.decisions[1].track, 5u);
  for (std::uint32_t j = 0; j < 3; ++j) EXPECT_EQ(usable.decisions[j].sighting, j);
}

TEST(UsableSightings, OneReasonForAllLeavesTheReasonsOfTheUnusableOnes) {
  Sighting bad = good(0.1);
  bad.direction.setZero();
  UsableSightings usable = usableSightings(scanOf({bad, good(0.2)}), 10);
  const std::string reason = usable.decisions[0].reason;
  usable.rejectAll("late: by far");
  EXPECT_EQ(usable.decisions[0].reason, reason);
  EXPECT_EQ(usable.decisions[1].reason, "late: by far");
  EXPECT_EQ(usable.decisions[1].decision, Decision::rejected_input);
}

TEST(UsableSightings, AScanWithoutIfovIsRefusedOnlyWhereSensorsAreWeighedByIt) {
  EstimatorParams params;
  params.kind = EstimatorKind::twbls;
  params.twbls_form = EstimatorForm::paper;
  Scan scan = scanOf({good(0.1)});
  EXPECT_FALSE(whyNotWeighable(scan, params));
  params.twbls.sensor_weight = SensorWeight::ifov;
  const auto refusal = whyNotWeighable(scan, params);
  ASSERT_TRUE(refusal);
  EXPECT_NE(refusal->detail.find("eye"), std::string::npos) << refusal->detail;
  scan.ifov = 1e-3;
  EXPECT_FALSE(whyNotWeighable(scan, params));
}

TEST(WithNoise, ScalesEveryCovarianceAndRemembersTheScale) {
  Scan scan = scanOf({good(0.1), good(0.2)});
  scan.noise_scale = 2.0;
  const Scan scaled = withNoise(scan, 3.0);
  EXPECT_EQ(scaled.noise_scale, 6.0);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(scaled.sightings[i].covariance, Eigen::Matrix3d(3.0 * scan.sightings[i].covariance));
    EXPECT_EQ(scaled.sightings[i].direction, scan.sightings[i].direction);
  }
}

}  // namespace
}  // namespace sightline::core
