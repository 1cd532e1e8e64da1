#include "sightline/formats/fireball_ecsv.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::readRecording;
using sightline::formats::Recording;

TEST(FireballEcsv, PicksOfTheDesertFireballNetworkAreDirectionsWithSigmaAndStation) {
  const Recording recording = readRecording(sample("dfn_small_36.ecsv"), {});
  ASSERT_EQ(recording.scans.size(), 6u);
  EXPECT_EQ(recording.format, "fireball ECSV");
  EXPECT_EQ(recording.scans[0].sensor, "DFNSMALL36");
  EXPECT_EQ(timeOf(recording.scans[0]), "1416928875386000000");
  const auto& sighting = recording.scans[0].sightings.at(0);
  EXPECT_NEAR(sighting.angles.x(), (90.0 - 200.873936804) * kDegree, 1e-12);
  EXPECT_NEAR(sighting.angles.y(), 35.1734265515 * kDegree, 1e-12);
  EXPECT_NEAR(sighting.sigma.x(), 0.0297372398225 * kDegree, 1e-12);
  EXPECT_NEAR(sighting.sigma.y(), 0.0318424073373 * kDegree, 1e-12);
  const auto& station = recording.stations.at("DFNSMALL36");
  EXPECT_NEAR(station.latitude, -30.6607733333 * kDegree, 1e-12);
  EXPECT_NEAR(station.longitude, 134.186036667 * kDegree, 1e-12);
  EXPECT_EQ(station.height, 149.1);
}

TEST(FireballEcsv, GlobalFireballExchangeNeedsASigmaAndMayHaveAnEmptyTelescope) {
  EXPECT_TRUE(contains(refusal([] { readRecording(sample("gfe.ecsv"), {}); }), "--sigma 0.05deg"));
  const Recording recording = readRecording(sample("gfe.ecsv"), withSigma());
  ASSERT_EQ(recording.scans.size(), 3u);
  EXPECT_EQ(recording.scans[0].sensor, "XX0001");
  EXPECT_NEAR(recording.scans[0].sightings[0].angles.x(), 0.0, 1e-12);
  EXPECT_NEAR(recording.scans[0].sightings[0].sigma.x(), 0.001 / std::cos(45.0 * kDegree), 1e-12);
  EXPECT_EQ(recording.scans[0].sightings[0].sigma.y(), 0.002);
  EXPECT_TRUE(contains(remarksOf(recording),
                       "picks without azimuth and altitude are left out (1 line, first line 24)"));
}

TEST(FireballEcsv, WithRightAscensionAloneItIsTurnedIntoTheHorizon) {
  std::string text =
      changed("gfe.ecsv", "datetime,ra,dec,azimuth,altitude", "datetime,ra,dec,azimuth,height");
  const Recording recording = read(text, withSigma());
  ASSERT_EQ(recording.scans.size(), 4u);
  EXPECT_TRUE(
      contains(remarksOf(recording),
               "from right ascension and declination (J2000), without refraction, UT1 - UTC taken for 0"));
}

TEST(FireballEcsv, MistakesAreNamedWithLineAndValue) {
  EXPECT_TRUE(contains(refusalOf(changed("dfn_small_36.ecsv", "35.1734265515", "x"), {}),
                       "altitude: expected degrees, got \"x\""));
  EXPECT_TRUE(contains(refusalOf(changed("gfe.ecsv", "2021-08-12T22:01:00.040000", "22:01"), withSigma()),
                       "file:23: datetime: expected 2014-11-25T15:21:15.386, got \"22:01\""));
  EXPECT_TRUE(contains(refusalOf(changed("gfe.ecsv", "403.5,303.5", "403.5"), withSigma()),
                       "file:25: expected 8 fields, got 7: is the file complete?"));
  EXPECT_TRUE(
      contains(refusalOf(changed("gfe.ecsv", "{name: ra", "{{name: ra"), withSigma()), "commented YAML"));
  EXPECT_TRUE(contains(
      refusalOf(changed("gfe.ecsv", "{name: dec, unit: deg", "{name: dec, unit: hourangle"), withSigma()),
      "dec: expected the unit deg, got \"hourangle\""));
  EXPECT_TRUE(contains(refusalOf(changed("gfe.ecsv", "90.0000,45.0000", "90.0000,145.0000"), withSigma()),
                       "file:22: "));
  EXPECT_TRUE(
      contains(refusalOf(changed("gfe.ecsv", "obs_latitude: 48.1370", "obs_latitude: 148.1370"), withSigma()),
               "is not on the earth"));
  EXPECT_TRUE(contains(refusalOf("# %ECSV 0.9\n# ---\n# datatype:\n"), "ends within the header"));
}

}  // namespace
