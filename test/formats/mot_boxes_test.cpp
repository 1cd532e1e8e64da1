#include "sightline/formats/mot_boxes.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::ImportOptions;
using sightline::formats::readRecording;

ImportOptions ofCamera() {
  ImportOptions options;
  options.sigma_pixels = 2.0;
  options.sensor = "cam";
  options.frame_rate = 10.0;
  options.image_size = Eigen::Vector2d(640.0, 480.0);
  options.field_of_view = Eigen::Vector2d(2.0 * std::atan(320.0 / 600.0), 2.0 * std::atan(240.0 / 600.0));
  options.offset = sightline::core::durationOf(100.0);
  return options;
}

TEST(MotBoxes, TheFirstPixelIsOneAndFramesWithoutBoxesSawNothing) {
  const auto recording = readRecording(sample("mot_det.txt"), ofCamera());
  ASSERT_EQ(recording.scans.size(), 5u);
  EXPECT_EQ(timeOf(recording.scans[0]), "100000000000");
  EXPECT_EQ(timeOf(recording.scans[4]), "100400000000");
  EXPECT_EQ(recording.scans[1].sightings.size(), 2u);
  EXPECT_TRUE(recording.scans[2].sightings.empty());
  // A box of one pixel at 1, 1 is the upper left pixel: 319.5 and 239.5 pixels left of and above the axis.
  const Eigen::Vector3d corner(600.0, 319.5, 239.5);
  EXPECT_LT(apart(recording.scans[0].sightings.at(0).angles, sightline::core::anglesOf(corner)), 1e-9);
  // Its opposite, 10 pixels wide up to 640 and 480: 4.5 pixels before the last one.
  const Eigen::Vector3d opposite(600.0, -315.0, -235.0);
  EXPECT_LT(apart(recording.scans[4].sightings.at(0).angles, sightline::core::anglesOf(opposite)), 1e-9);
}

TEST(MotBoxes, SigmasInPixelsAreThoseOfTheLens) {
  ImportOptions options = ofCamera();
  const auto recording = read("1,-1,320,240,2,2,1,-1,-1,-1\n", options);
  const auto& sighting = recording.scans.at(0).sightings.at(0);
  EXPECT_LT(apart(sighting.angles, {0.0, 0.0}), 1e-9);
  EXPECT_NEAR(sighting.sigma.x(), 2.0 / 600.0, 1e-9);
  EXPECT_NEAR(sighting.sigma.y(), 2.0 / 600.0, 1e-9);
}

TEST(MotBoxes, ACalibrationOfThePinholeIsTheFieldOfViewAgain) {
  ImportOptions options = ofCamera();
  options.field_of_view.reset();
  options.camera = sample("camera.yaml");
  const auto by_camera = readRecording(sample("mot_det.txt"), options);
  const auto by_view = readRecording(sample("mot_det.txt"), ofCamera());
  for (std::size_t i = 0; i < by_camera.scans.size(); ++i) {
    for (std::size_t k = 0; k < by_camera.scans[i].sightings.size(); ++k)
      EXPECT_LT(apart(by_camera.scans[i].sightings[k].angles, by_view.scans[i].sightings[k].angles), 1e-12);
  }
}

TEST(MotBoxes, ATruthCountsOnlyWhatIsMarkedAndNamesItsTargets) {
  ImportOptions options = ofCamera();
  options.for_truth = true;
  options.sigma_pixels.reset();
  const auto recording = readRecording(sample("mot_gt.txt"), options);
  EXPECT_EQ(sightingsOf(recording), 2u);
  const std::string truth = sightline::formats::truthCsv(recording);
  EXPECT_EQ(truth.substr(0, 60), "time,target,sensor,azimuth,elevation\n100.000000000,7,cam,0.0");
}

TEST(MotBoxes, MistakesAreNamed) {
  ImportOptions options = ofCamera();
  options.image_size.reset();
  EXPECT_TRUE(contains(refusal([&] { readRecording(sample("mot_det.txt"), options); }), "--field-of-view"));
  options = ofCamera();
  options.frame_rate.reset();
  EXPECT_TRUE(contains(refusal([&] { readRecording(sample("mot_det.txt"), options); }), "--frame-rate"));
  options = ofCamera();
  options.sigma_pixels.reset();
  EXPECT_TRUE(contains(refusal([&] { readRecording(sample("mot_det.txt"), options); }), "--sigma"));
  options = ofCamera();
  options.camera = sample("gfe.ecsv");
  EXPECT_TRUE(
      contains(refusal([&] { readRecording(sample("mot_det.txt"), options); }), "calibration of a camera"));
  EXPECT_TRUE(
      contains(refusalOf("1,-1,1,1,1,1,1\n2,-1,1,1\n", ofCamera()), "file:2: expected 7 to 10 numbers"));
  EXPECT_TRUE(contains(refusalOf("1,-1,1,1,0,1,1\n", ofCamera()), "width and height"));
  EXPECT_TRUE(contains(refusalOf("1,-1,1,1,1,1,1\n1e9,-1,1,1,1,1,1\n", ofCamera()),
                       "file:2: frame: expected a whole number"));
}

}  // namespace
