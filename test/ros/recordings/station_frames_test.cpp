#include "sightline/ros/recordings/station_frames.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/NavSatFix.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/csv_recordings.h"

#include "support/scratch_folder.h"

namespace {

using sightline_ros::convertCsvToBag;
using Transforms = std::map<std::string, geometry_msgs::TransformStamped>;  // by child frame

const std::string kSightings =
    "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation\n10,a,0.1,0.2,1e-3,1e-3\n11,b,0.1,0.2,1e-3,"
    "1e-3\n";

struct Contents {
  Transforms transforms;
  std::vector<sensor_msgs::NavSatFix> origins;
  std::map<std::string, std::string> latching;  // by topic
  std::map<std::string, std::string> frames;    // by sensor
};

Contents contentsOf(const std::string& file) {
  Contents contents;
  const auto bag = sightline_ros::openBag(file);
  rosbag::View view(*bag);
  for (const rosbag::MessageInstance& instance : view) {
    if (const auto tf = instance.instantiate<tf2_msgs::TFMessage>()) {
      for (const auto& transform : tf->transforms) contents.transforms[transform.child_frame_id] = transform;
    }
    if (const auto fix = instance.instantiate<sensor_msgs::NavSatFix>()) contents.origins.push_back(*fix);
    if (const auto scan = instance.instantiate<sightline::SightingArray>())
      contents.frames[scan->sensor] = scan->header.frame_id;
  }
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    const auto found = connection->header->find("latching");
    contents.latching[connection->topic] = found != connection->header->end() ? found->second : "0";
  }
  return contents;
}

Contents converted(const std::string& stations) {
  const ScratchFolder folder;
  convertCsvToBag(folder.write("in.csv", kSightings), folder.file("out.bag"), "platform_enu", 0.0,
                  folder.write("stations.csv", stations));
  return contentsOf(folder.file("out.bag"));
}

TEST(StationFrames, StationsInMetresStandInWorldWithParallelAxes) {
  const Contents contents = converted("sensor,east_m,north_m,up_m\na,0,0,0\nb,-84.131,-49.774,2.515\n");
  ASSERT_EQ(contents.transforms.size(), 2u);
  const auto& b = contents.transforms.at("b");
  EXPECT_EQ(b.header.frame_id, "world");
  EXPECT_EQ(b.transform.translation.x, -84.131);
  EXPECT_EQ(b.transform.translation.z, 2.515);
  EXPECT_EQ(b.transform.rotation.w, 1.0);
  EXPECT_EQ(contents.frames.at("b"), "b");
  EXPECT_EQ(contents.latching.at("/tf_static"), "1");
  EXPECT_TRUE(contents.origins.empty());
}

TEST(StationFrames, StationsOnTheEarthStandAtTheirDistancesAndWorldKnowsItsPlace) {
  const Contents contents =
      converted("sensor,latitude_deg,longitude_deg,height_m\na,48,10,500\nb,48,11,500\n");
  const auto& a = contents.transforms.at("a").transform;
  EXPECT_NEAR(a.translation.x, -37291.0, 100.0);  // half a degree of longitude, 111.6 km cos(48 deg)
  EXPECT_GT(std::abs(a.rotation.y), 1e-3);        // its up leans to the west
  ASSERT_EQ(contents.origins.size(), 1u);
  EXPECT_NEAR(contents.origins[0].longitude, 10.5, 1e-9);
  EXPECT_EQ(contents.origins[0].header.frame_id, "world");
  EXPECT_EQ(contents.latching.at("/world_origin"), "1");
}

TEST(StationFrames, StationsAtOnePlaceHaveTheTrackingFrameThere) {
  EXPECT_EQ(converted("sensor,east_m,north_m,up_m\na,5,0,0\nb,5.5,0,0\n").transforms.count("platform_enu"),
            1u);
  EXPECT_EQ(converted("sensor,east_m,north_m,up_m\na,5,0,0\nb,15,0,0\n").transforms.count("platform_enu"),
            0u);
}

TEST(StationFrames, ASensorWithoutAPlaceIsRefusedAndNothingIsWritten) {
  const ScratchFolder folder;
  const std::string stations = folder.write("stations.csv", "sensor,east_m,north_m,up_m\na,0,0,0\n");
  try {
    convertCsvToBag(folder.write("in.csv", kSightings), folder.file("out.bag"), "platform_enu", 0.0,
                    stations);
    FAIL() << "expected a refusal";
  } catch (const std::runtime_error& problem) {
    EXPECT_EQ(std::string(problem.what()),
              "sensor \"b\" has no place among the stations: add it to " + stations);
  }
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.bag")));
}

TEST(StationFrames, SightingsOfABagBecomeATableAndABagAgain) {
  const ScratchFolder folder;
  const std::string text =
      "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation,scan\n"
      "10.000000000,a,0.1,0.2,0.001,0.002,1\n10.000000000,a,0.3,0.2,0.001,0.002,1\n11.500000000,a,,,,,2\n";
  convertCsvToBag(folder.write("in.csv", text), folder.file("out.bag"), "f", 0.0);
  sightline_ros::convertBagToSightingCsv(folder.file("out.bag"), folder.file("out.csv"), {});
  std::ostringstream back;
  back << std::ifstream(folder.file("out.csv")).rdbuf();
  EXPECT_EQ(back.str(), text);
}

}  // namespace
