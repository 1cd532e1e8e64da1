#include "sightline/ros/adapters/spot_detector_params.h"

#include <string>

#include <gtest/gtest.h>

#include "support/paths.h"
#include "support/scratch_folder.h"

namespace sightline_ros {
namespace {

class SpotDetectorParamsFile : public testing::Test {
 protected:
  std::string complaintAbout(const std::string& yaml) {
    try {
      const ParamReader reader = ParamReader::fromYaml(folder_.write("spots.yaml", yaml));
      loadSpotDetectorParams(reader);
      reader.finish();
    } catch (const ParamError& error) {
      return error.what();
    }
    return "";
  }

  ScratchFolder folder_;
};

TEST_F(SpotDetectorParamsFile, TheShippedOneHoldsEveryDefault) {
  const ParamReader reader =
      ParamReader::fromYaml(sightline::test::sourceDirectory() + "/config/spot_detector.yaml");
  loadSpotDetectorParams(reader);
  reader.finish();
  for (const std::string& name : reader.differences()) {
    EXPECT_TRUE(name.find("detection_probability") != std::string::npos ||
                name.find("clutter_density") != std::string::npos)
        << name;
  }
}

TEST_F(SpotDetectorParamsFile, WhatMakesNoSenseIsRefused) {
  const auto has = [&](const std::string& yaml, const std::string& text) {
    const std::string complaint = complaintAbout(yaml);
    return complaint.find(text) != std::string::npos;
  };
  EXPECT_TRUE(has("{guard: 5, neighbourhood: 5}", "neighbourhood: expected more than guard (5), got 5"));
  EXPECT_TRUE(has("{field_of_view: [24.0, 19.0]}", "field_of_view[0]: expected a number in [0, 3.14"));
  EXPECT_TRUE(has("{field_of_view: [0.4, 0.0]}", "field_of_view: expected two angles above 0"));
  EXPECT_TRUE(has("{polarity: hot}", "polarity: expected one of bright, dark, both"));
  EXPECT_TRUE(has("{treshold: 5.0}", "did you mean"));
  EXPECT_TRUE(has("{memory: 5, warm_up: 6}", "warm_up: expected a whole number in [1, 5]"));
}

}  // namespace
}  // namespace sightline_ros
