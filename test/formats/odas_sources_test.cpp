#include "sightline/formats/odas_sources.h"

#include <string>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::ImportOptions;
using sightline::formats::readRecording;

ImportOptions ofArray() {
  ImportOptions options = withSigma();
  options.sensor = "mic";
  options.frame_rate = 125.0;
  return options;
}

TEST(OdasSources, SourcesAreDirectionsAndEmptyPlacesAreNone) {
  const auto recording = readRecording(sample("odas_tracked.json"), ofArray());
  ASSERT_EQ(recording.scans.size(), 3u);
  EXPECT_EQ(timeOf(recording.scans[0]), "800000000");
  ASSERT_EQ(recording.scans[0].sightings.size(), 1u);
  EXPECT_LT(apart(recording.scans[0].sightings[0].angles, {45.0 * kDegree, 0.0}), 1e-6);
  EXPECT_EQ(recording.scans[0].sightings[0].target, "3");
  EXPECT_TRUE(recording.scans[1].sightings.empty());
  EXPECT_LT(apart(recording.scans[2].sightings.at(0).angles, {90.0 * kDegree, 30.0 * kDegree}), 1e-6);
}

TEST(OdasSources, PotentialSourcesAndTheLeastConfidence) {
  ImportOptions options = ofArray();
  EXPECT_EQ(sightingsOf(readRecording(sample("odas_potential.json"), options)), 2u);
  options.least_confidence = 0.1;
  options.heading = 90.0 * kDegree;
  const auto recording = readRecording(sample("odas_potential.json"), options);
  ASSERT_EQ(sightingsOf(recording), 1u);
  EXPECT_LT(apart(recording.scans[0].sightings[0].angles, {-90.0 * kDegree, 0.0}), 1e-6);
}

TEST(OdasSources, MistakesAreNamed) {
  ImportOptions options = ofArray();
  options.frame_rate.reset();
  EXPECT_TRUE(
      contains(refusal([&] { readRecording(sample("odas_tracked.json"), options); }), "--frame-rate"));
  const std::string text = sightline::formats::TextFile::fromFile(sample("odas_tracked.json")).text();
  EXPECT_TRUE(contains(refusalOf(text.substr(0, text.size() - 30), ofArray()),
                       "file:15: the last object is not complete"));
  EXPECT_TRUE(
      contains(refusalOf(changed("odas_tracked.json", "\"x\": 0.707107", "\"x\": \"left\""), ofArray()),
               "no JSON of ODAS"));
  EXPECT_TRUE(contains(refusalOf(changed("odas_tracked.json", "\"src\"", "\"sources\""), ofArray()),
                       "expected an object with"));
}

}  // namespace
