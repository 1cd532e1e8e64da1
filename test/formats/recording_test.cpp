#include "sightline/formats/recording.h"

#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using namespace sightline::formats;

sightline::core::Time stamp(std::int64_t since_epoch_ns) {
  return sightline::core::timeOf(since_epoch_ns);
}

FileSighting at(double azimuth, double elevation) {
  FileSighting sighting;
  sighting.angles = {azimuth, elevation};
  return sighting;
}

TEST(RecordingBuilder, ScansAreInOrderWithTheSightingsOfOneTimeAndSensorTogether) {
  const TextFile file("f", "x");
  ImportOptions options = withSigma();
  options.offset = sightline::core::durationOf(1.0);
  RecordingBuilder builder("a test", file, options);
  builder.add(1, stamp(20), "b", at(0.1, 0.0));
  builder.add(1, stamp(10), "b", at(0.2, 0.0));
  builder.add(1, stamp(20), "b", at(0.3, 0.0));
  builder.addEmpty(1, stamp(20), "a");
  const Recording recording = builder.finish();
  ASSERT_EQ(recording.scans.size(), 3u);
  EXPECT_EQ(timeOf(recording.scans[0]), "1000000010");
  EXPECT_EQ(recording.scans[1].sensor, "a");
  EXPECT_TRUE(recording.scans[1].sightings.empty());
  EXPECT_EQ(recording.scans[2].sightings.size(), 2u);
}

TEST(RecordingBuilder, SigmasThatAreToldAreArcsAndThoseOfTheFileStay) {
  const TextFile file("f", "x");
  const ImportOptions options = withSigma();
  RecordingBuilder builder("a test", file, options);
  FileSighting half = at(0.0, 1.0);
  half.sigma.y() = 0.03;
  builder.add(1, stamp(1), "a", half);
  builder.add(1, stamp(2), "a", at(0.0, 0.5 * sightline::core::kPi));
  const Recording recording = builder.finish();
  EXPECT_NEAR(recording.scans[0].sightings[0].sigma.x(), 0.001 / std::cos(1.0), 1e-15);
  EXPECT_EQ(recording.scans[0].sightings[0].sigma.y(), 0.03);
  EXPECT_TRUE(std::isfinite(recording.scans[1].sightings[0].sigma.x()));
  EXPECT_TRUE(contains(remarksOf(recording), "sigma of 2 sightings as told"));
}

TEST(RecordingBuilder, OptionsThatTheFileMakesNeedlessAreSaid) {
  const TextFile file("f", "x");
  ImportOptions options = withSigma();
  options.sensor = "told";
  RecordingBuilder builder("a test", file, options);
  FileSighting sighting = at(0.1, 0.0);
  sighting.sigma = {0.01, 0.01};
  EXPECT_EQ(builder.sensorOr("own", 3), "own");
  EXPECT_EQ(builder.sensorOr(" ", 4), "told");
  builder.add(3, stamp(1), "own", sighting);
  const std::string remarks = remarksOf(builder.finish());
  EXPECT_TRUE(
      contains(remarks, "--sensor is for those without a name and is not used (1 line, first line 3)"));
  EXPECT_TRUE(contains(remarks, "sigma of 1 sightings is the file's"));
}

TEST(RecordingBuilder, WhatTrackersWouldRejectIsRefusedWithItsLine) {
  const TextFile file("f", "x");
  const ImportOptions options = withSigma();
  RecordingBuilder builder("a test", file, options);
  EXPECT_TRUE(contains(refusal([&] { builder.add(7, stamp(1), "a", at(0.0, 2.0)); }), "f:7: direction"));
  FileSighting wrong = at(0.0, 0.0);
  wrong.sigma = {0.001, -0.001};
  EXPECT_TRUE(contains(refusal([&] { builder.add(8, stamp(1), "a", wrong); }), "f:8: a sigma is negative"));
  EXPECT_TRUE(contains(refusal([&] { builder.finish(); }), "there is no sighting in this a test file"));
}

TEST(RecordingBuilder, StationsOfTheFileComeBeforeThoseThatAreTold) {
  const TextFile file("f", "x");
  ImportOptions options = withSigma();
  options.stations[""] = {0.1, 0.1, 1.0};
  options.stations["b"] = {0.2, 0.2, 2.0};
  RecordingBuilder builder("a test", file, options);
  builder.setStation("a", {0.3, 0.3, 3.0});
  for (const char* sensor : {"a", "b", "c"}) builder.addEmpty(1, stamp(1), sensor);
  EXPECT_EQ(builder.station("b", 1, "a test").height, 2.0);
  const Recording recording = builder.finish();
  EXPECT_EQ(recording.stations.at("a").height, 3.0);
  EXPECT_EQ(recording.stations.at("b").height, 2.0);
  EXPECT_EQ(recording.stations.at("c").height, 1.0);
}

TEST(Compass, NorthIsNinetyDegreesAndEastIsZero) {
  EXPECT_NEAR(fromCompass(0.0), 90.0 * kDegree, 1e-15);
  EXPECT_NEAR(fromCompass(90.0 * kDegree), 0.0, 1e-15);
  EXPECT_NEAR(fromCompass(359.0 * kDegree), 91.0 * kDegree, 1e-12);
  EXPECT_NEAR(fromCompass(200.0 * kDegree), -110.0 * kDegree, 1e-12);
}

TEST(Merged, ManyFilesAreOneRecordingUnlessTheyDisagreeOnAStation) {
  Recording a, b;
  a.format = b.format = "x";
  a.scans.push_back({stamp(2), "s", {}});
  b.scans.push_back({stamp(1), "s", {}});
  a.stations["s"] = {0.5, 0.5, 0.0};
  b.stations["s"] = {0.5, 0.5, 0.5};
  EXPECT_EQ(timeOf(merged({a, b}).scans.at(0)), "1");
  b.stations["s"].height = 3.0;
  EXPECT_TRUE(contains(refusal([&] { merged({a, b}); }), "two places"));
}

TEST(Merged, AFileThatIsGivenTwiceIsSaid) {
  Recording a;
  a.scans.push_back({stamp(2), "s", {}});
  EXPECT_TRUE(merged({a}).remarks.empty());
  EXPECT_TRUE(contains(remarksOf(merged({a, a})), "1 times of s stand in more than one file"));
}

}  // namespace
