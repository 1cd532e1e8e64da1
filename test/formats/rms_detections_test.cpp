#include "sightline/formats/rms_detections.h"

#include <string>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::readRecording;

TEST(RmsDetections, CalibratedPicksAreDirectionsAtTheTimesOfTheirFrames) {
  const auto recording = readRecording(sample("rms.txt"), withSigma());
  ASSERT_EQ(recording.scans.size(), 4u);
  EXPECT_EQ(recording.scans[0].sensor, "XX0001");
  EXPECT_EQ(timeOf(recording.scans[0]), "1628805664250000000");  // 22:01:00.250 and 100 frames of 40 ms
  EXPECT_EQ(timeOf(recording.scans[2]), "1628805664350000000");
  EXPECT_NEAR(recording.scans[0].sightings[0].angles.x(), 0.0, 1e-12);
  EXPECT_NEAR(recording.scans[0].sightings[0].angles.y(), 45.0 * kDegree, 1e-12);
  EXPECT_NEAR(recording.scans[2].sightings[0].angles.x(), 90.5 * kDegree, 1e-12);
  EXPECT_NE(recording.scans[0].sightings[0].target, recording.scans[3].sightings[0].target);
}

TEST(RmsDetections, UncalibratedMeteorsAndPicksThatAreNoNumbersAreLeftOutAndSaid) {
  const std::string remarks = remarksOf(readRecording(sample("rms.txt"), withSigma()));
  EXPECT_TRUE(contains(remarks, "1 uncalibrated meteors are left out, the first on line 21"));
  EXPECT_TRUE(contains(remarks, "picks with NaN are left out (1 line, first line 30)"));
}

TEST(RmsDetections, AFileOfUncalibratedMeteorsIsRefused) {
  std::string text = changed("rms.txt", "Recalibrated with RMS on: 2021-08-13 07:00:00 UTC", "Uncalibrated");
  text = text.replace(text.find("Recalibrated"), 12, "Uncalibrated");
  EXPECT_TRUE(contains(refusalOf(text, withSigma()), "file:14: all 3 meteors are uncalibrated"));
}

TEST(RmsDetections, MistakesAreNamed) {
  EXPECT_TRUE(contains(refusal([] { readRecording(sample("rms.txt"), {}); }), "--sigma"));
  EXPECT_TRUE(
      contains(refusalOf(changed("rms.txt", "090.0000 +45.0000 000345 2.10", "090.0000"), withSigma()),
               "file:16: expected frame, column, row"));
  EXPECT_TRUE(contains(refusalOf(changed("rms.txt", "+45.0000", "+145.0000"), withSigma()),
                       "no degrees of a direction"));
  EXPECT_TRUE(contains(refusalOf(changed("rms.txt", "FF_XX0001_20210812_220100_250", "UFO"), withSigma()),
                       "file:13: \"UFO_0001024.fits\" has no time in it"));
  EXPECT_TRUE(contains(refusalOf(changed("rms.txt", "0003 0025.00", "0003 00"), withSigma()), "file:15: "));
  const std::string text = sightline::formats::TextFile::fromFile(sample("rms.txt")).text();
  EXPECT_TRUE(
      contains(refusalOf(text.substr(0, text.find("Per segment")), withSigma()), "the file is not complete"));
  EXPECT_TRUE(contains(refusalOf(text.substr(0, text.find("XX0001 0001 0002")), withSigma()), "ends before"));
}

}  // namespace
