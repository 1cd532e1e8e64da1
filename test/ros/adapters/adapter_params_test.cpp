#include "sightline/ros/adapters/adapter_params.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/paths.h"
#include "support/scratch_folder.h"

namespace sightline_ros {
namespace {

class AdapterParams : public testing::Test {
 protected:
  std::vector<AdapterTopic> load(const std::string& yaml) {
    const ParamReader reader = ParamReader::fromYaml(folder_.write("adapter.yaml", yaml));
    const auto topics = loadAdapterTopics(reader);
    reader.finish();
    return topics;
  }

  std::string complaintAbout(const std::string& yaml) {
    try {
      load(yaml);
    } catch (const ParamError& error) {
      return error.what();
    }
    return "";
  }

  ScratchFolder folder_;
};

void expectIn(const std::string& text, const std::string& whole) {
  EXPECT_NE(whole.find(text), std::string::npos) << whole;
}

TEST_F(AdapterParams, TheShippedExampleLoadsWithOneOfEveryKind) {
  const ParamReader reader =
      ParamReader::fromYaml(sightline::test::sourceDirectory() + "/config/sighting_adapter.yaml");
  const auto topics = loadAdapterTopics(reader);
  reader.finish();
  ASSERT_EQ(topics.size(), 11u);
  for (std::size_t i = 0; i < topics.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(topics[i].kind), i) << topics[i].type;
  }
  EXPECT_EQ(topics[0].output, "/sensors/seeker/sightings");
  const Quantity& heading = topics[10].fields.axes[0];
  EXPECT_NEAR(heading.scale, -3.14159265358979 / 180.0, 1e-12);
  EXPECT_NEAR(heading.offset, 3.14159265358979 / 2.0, 1e-12);
}

TEST_F(AdapterParams, WithoutATopicListThereIsNothingToDo) {
  expectIn("topics: expected a list with an entry for each topic", complaintAbout("{}"));
  expectIn("topics: expected a list with an entry for each topic", complaintAbout("topics: []"));
}

TEST_F(AdapterParams, AMissingSigmaIsRefusedWhereTheMessagesHaveNoCovariance) {
  expectIn("topics[0]/sigma: expected two numbers [rad]",
           complaintAbout("topics: [{topic: /a, type: geometry_msgs/Vector3Stamped, sensor: a}]"));
  expectIn(
      "topics[0]/sigma_px: expected two numbers [px]",
      complaintAbout("topics: [{topic: /a, type: geometry_msgs/PointStamped, sensor: a, camera_info: /c}]"));
  EXPECT_EQ(complaintAbout("topics: [{topic: /a, type: nav_msgs/Odometry, sensor: a}]"), "");
}

TEST_F(AdapterParams, SigmasInDegreesAreRefused) {
  expectIn(
      "topics[0]/sigma[0]: expected a number in [1e-09",
      complaintAbout("topics: [{topic: /a, type: geometry_msgs/PoseStamped, sensor: a, sigma: [2.0, 2.0]}]"));
}

TEST_F(AdapterParams, AKeyOfAnotherKindIsRefused) {
  expectIn("sigma_px: nobody reads this parameter",
           complaintAbout("topics: [{topic: /a, type: nav_msgs/Odometry, sensor: a, sigma_px: [1.0, 1.0]}]"));
  expectIn("did you mean",
           complaintAbout("topics: [{topic: /a, type: nav_msgs/Odometry, sensor: a, stamp_offest: 0.1}]"));
}

TEST_F(AdapterParams, ABoxNeedsItsCamera) {
  expectIn("camera_info: expected a string",
           complaintAbout(
               "topics: [{topic: /a, type: sensor_msgs/RegionOfInterest, sensor: a, sigma_px: [1.0, 1.0]}]"));
}

TEST_F(AdapterParams, AnUnknownTypeNeedsExactlyOneFormOfFields) {
  expectIn("got none (types read without them: geometry_msgs/PointStamped",
           complaintAbout("topics: [{topic: /a, type: acme/Thing, sensor: a, sigma: [0.1, 0.1]}]"));
  expectIn("got several",
           complaintAbout("topics: [{topic: /a, type: acme/Thing, sensor: a, sigma: [0.1, 0.1], "
                          "azimuth: {field: a}, x: {field: x}}]"));
  expectIn("topics[0]/azimuth/unit: expected one of deg, mrad, rad",
           complaintAbout("topics: [{topic: /a, type: acme/Thing, sensor: a, sigma: [0.1, 0.1], "
                          "azimuth: {field: a, unit: degrees}}]"));
  expectIn("topics[0]/azimuth/sign: expected 1 or -1",
           complaintAbout("topics: [{topic: /a, type: acme/Thing, sensor: a, sigma: [0.1, 0.1], "
                          "azimuth: {field: a, sign: 0}}]"));
}

TEST_F(AdapterParams, ZerosAreUnusedSlotsOfListsAndElseAMistake) {
  const auto zerosOf = [this](const std::string& entry) {
    return load("topics: [{topic: /a, sensor: a, sigma: [0.1, 0.1], " + entry + "}]").at(0).zero_is_nothing;
  };
  const std::string xyz = "x: {field: x}, y: {field: y}, z: {field: z}";
  EXPECT_TRUE(zerosOf("type: acme/Sources, each: sources, " + xyz));
  EXPECT_FALSE(zerosOf("type: acme/Source, " + xyz));
  EXPECT_TRUE(zerosOf("type: acme/Source, zeros: nothing, " + xyz));
  EXPECT_FALSE(zerosOf("type: acme/Sources, each: sources, zeros: refused, " + xyz));
  EXPECT_TRUE(zerosOf("type: sensor_msgs/PointCloud2"));
  EXPECT_FALSE(zerosOf("type: geometry_msgs/PoseArray"));
  EXPECT_TRUE(zerosOf("type: geometry_msgs/PoseArray, zeros: nothing"));
  expectIn("zeros: nobody reads this parameter",
           complaintAbout("topics: [{topic: /a, sensor: a, sigma: [0.1, 0.1], type: sensor_msgs/LaserScan, "
                          "zeros: nothing}]"));
}

TEST_F(AdapterParams, ABoxOfCornersNeedsAllFourAndItsCamera) {
  const std::string entry = "topics: [{topic: /a, sensor: a, type: acme/Boxes, sigma_px: [1.0, 1.0], ";
  expectIn("xmax/field: expected a string",
           complaintAbout(entry + "camera_info: /c, xmin: {field: a}, ymin: {field: b}, ymax: {field: d}}]"));
  const std::string corners = "xmin: {field: a}, xmax: {field: b}, ymin: {field: c}, ymax: {field: d}";
  expectIn("camera_info: expected a string", complaintAbout(entry + corners + "}]"));
  expectIn("got several", complaintAbout(entry + corners + ", u: {field: u}, camera_info: /c}]"));
  const auto topics = load(entry + corners + ", camera_info: /c}]");
  EXPECT_EQ(topics.at(0).fields.form, FieldMap::Form::corners);
  EXPECT_TRUE(topics.at(0).is_optical);
}

TEST_F(AdapterParams, TwoSensorsOfOneNameAreRefused) {
  expectIn("topics[1]/sensor: \"a\" names an entry before it too",
           complaintAbout("topics: [{topic: /a, type: nav_msgs/Odometry, sensor: a}, "
                          "{topic: /b, type: nav_msgs/Odometry, sensor: a}]"));
}

}  // namespace
}  // namespace sightline_ros
