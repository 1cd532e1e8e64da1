#include "sightline/formats/cmn_sightings.h"

#include <cmath>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::readRecording;

TEST(CmnSightings, StarsBecomeDirectionsAtTheStationOfTheFile) {
  const auto recording = readRecording(sample("cmn_apo.txt"), withSigma());
  ASSERT_EQ(recording.scans.size(), 14u);
  EXPECT_EQ(recording.scans[0].sensor, "APO");
  EXPECT_NEAR(recording.stations.at("APO").latitude, 45.819722 * kDegree, 1e-12);
  EXPECT_NEAR(recording.stations.at("APO").longitude, 17.357222 * kDegree, 1e-12);
  EXPECT_EQ(recording.stations.at("APO").height, 135.0);
  // The Julian date of the first line is 2017-03-05T22:50:04.129, as its head says to some milliseconds.
  EXPECT_NEAR(sightline::core::seconds(recording.scans[0].time - sightline::core::Time{}), 1488754204.132,
              0.02);
  // By hand: sidereal time 163.75 degrees at the station, hour angle 81.7 (west), elevation 28.9 degrees but
  // for the precession since 2000.
  const auto& first = recording.scans[0].sightings[0].angles;
  EXPECT_GT(std::abs(first.x()), 0.5 * sightline::core::kPi);
  EXPECT_NEAR(first.y(), 28.93 * kDegree, 0.3 * kDegree);
}

TEST(CmnSightings, MistakesAreNamed) {
  EXPECT_TRUE(contains(refusal([] { readRecording(sample("cmn_apo.txt"), {}); }), "--sigma"));
  EXPECT_TRUE(contains(refusalOf(changed("cmn_apo.txt", "082.017 +33.950 +1.2", "082.017"), withSigma()),
                       "file:7: expected a Julian date, right ascension and declination"));
  EXPECT_TRUE(
      contains(refusalOf(changed("cmn_apo.txt", "+33.950", "+133.950"), withSigma()), "\"+133.950\""));
  EXPECT_TRUE(contains(refusalOf(changed("cmn_apo.txt", "017.357222 E", "017.357222"), withSigma()),
                       "file:4: Long: expected for instance \"017.357222 E\""));
  EXPECT_TRUE(
      contains(refusalOf(changed("cmn_apo.txt", "Height: 0135 m\n", ""), withSigma()), "--station APO="));
}

}  // namespace
