#include "sightline/formats/krakensdr_bearings.h"

#include <cmath>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::ImportOptions;
using sightline::formats::readRecording;

ImportOptions ofFinder() {
  ImportOptions options = withSigma();
  options.elevation = 0.0;
  options.sensor = "df";
  return options;
}

TEST(KrakenSdr, BearingsAreCounterClockwiseFromTheAxisAndTimesAreMilliseconds) {
  const auto recording = read("1700000000123, 40, 6.0, -35.2, 433920000, UCA, 512\n", ofFinder());
  EXPECT_EQ(timeOf(recording.scans.at(0)), "1700000000123000000");
  const auto& sighting = recording.scans[0].sightings.at(0);
  EXPECT_NEAR(sighting.angles.x(), 40.0 * kDegree, 1e-12);
  EXPECT_NEAR(sighting.snr, std::pow(10.0, 0.3), 1e-12);
  EXPECT_TRUE(contains(remarksOf(recording), "counter-clockwise"));
  EXPECT_TRUE(contains(remarksOf(recording), "--heading"));
}

TEST(KrakenSdr, ThePeakOfTheSpectrumSaysWhichWayBearingsTurnAndTheHeadingIsAdded) {
  const auto recording = readRecording(sample("krakensdr.csv"), ofFinder());
  ASSERT_EQ(recording.scans.size(), 3u);
  EXPECT_EQ(recording.scans[0].sensor, "df1");
  // 100 degrees counter-clockwise from an axis of compass heading 30: 60 degrees from east
  EXPECT_NEAR(recording.scans[0].sightings[0].angles.x(), 160.0 * kDegree, 1e-12);
  EXPECT_TRUE(contains(remarksOf(recording), "clockwise, as the peaks of the spectra show"));
  EXPECT_TRUE(contains(remarksOf(recording), "48.1370,11.5750"));
  ImportOptions told = ofFinder();
  told.heading = 90.0 * kDegree;
  EXPECT_NEAR(readRecording(sample("krakensdr.csv"), told).scans[0].sightings[0].angles.x(), 100.0 * kDegree,
              1e-12);
}

TEST(KrakenSdr, BearingsBelowTheLeastConfidenceAreNotSeen) {
  ImportOptions options = ofFinder();
  options.least_confidence = 7.0;
  const auto recording = readRecording(sample("krakensdr.csv"), options);
  EXPECT_EQ(recording.scans.size(), 3u);
  EXPECT_EQ(sightingsOf(recording), 2u);
}

TEST(KrakenSdr, MistakesAreNamed) {
  EXPECT_TRUE(
      contains(refusalOf("1700000000123, 40, 6.0, -35.2, 433920000, UCA, 512\n"), "--elevation 0deg"));
  EXPECT_TRUE(contains(refusalOf("1700000000, 40, 6.0, -35.2, 433920000, UCA, 512\n", ofFinder()),
                       "are these seconds?"));
  EXPECT_TRUE(contains(refusalOf("1700000000123, 400, 6.0, -35.2, 433920000, UCA, 512\n", ofFinder()),
                       "got \"400\""));
  EXPECT_TRUE(contains(refusalOf("1700000000123, 40, 6, -3, 4, UCA, 5\n1700000000623, 40, 6\n", ofFinder()),
                       "file:2: expected epoch, bearing"));
}

}  // namespace
