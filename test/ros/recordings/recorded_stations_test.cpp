#include "sightline/ros/recordings/recorded_stations.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <tf2_msgs/TFMessage.h>

#include "support/scratch_folder.h"
#include "support/seen_stations.h"

namespace {

using sightline::test::SeenStation;
using sightline::test::targetAt;
using sightline_ros::RecordedStations;
using sightline_ros::recordedStationsOf;

/// Stations at (x, 0, 0) m, with their places in `world` and a scan of each.
RecordedStations stationsAt(const std::vector<std::pair<std::string, double>>& places, bool with_tf = true) {
  const ScratchFolder folder;
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
    tf2_msgs::TFMessage frames;
    for (const auto& [name, x] : places) {
      SeenStation station(name, {x, 0.0, 0.0}, 0.3, 1);
      frames.transforms.push_back(station.transform(ros::Time(10.0), "world"));
      bag.write("/" + name, ros::Time(10.0 + x), station.scan(ros::Time(10.0 + x), targetAt(0.0)));
    }
    if (with_tf) bag.write("/tf_static", ros::Time(10.0), frames);
  }
  const rosbag::Bag bag(folder.file("in.bag"));
  return recordedStationsOf(bag, "world");
}

TEST(RecordedStations, SensorsWithinAMetreAreOneStation) {
  const RecordedStations found = stationsAt({{"a", 0.0}, {"b", 0.5}, {"c", 30.0}});
  EXPECT_TRUE(found.standApart());
  EXPECT_NEAR(found.apart, 30.0, 1e-9);
  ASSERT_EQ(found.stations.size(), 2u);
  EXPECT_EQ(found.stations[0].name, "eye of a");
  EXPECT_EQ(found.stations[0].frame, "a");
  EXPECT_EQ(found.stations[0].sensors, (std::vector<std::string>{"eye of a", "eye of b"}));
  EXPECT_EQ(found.stations[1].sensors, std::vector<std::string>{"eye of c"});
}

TEST(RecordedStations, SensorsAtOnePlaceOrWithoutPlacesDoNotStandApart) {
  EXPECT_FALSE(stationsAt({{"a", 0.0}, {"b", 0.9}}).standApart());
  const RecordedStations unknown = stationsAt({{"a", 0.0}, {"b", 40.0}}, false);
  EXPECT_FALSE(unknown.standApart());
  EXPECT_EQ(unknown.stations.size(), 2u);
}

TEST(RecordedStations, SensorsOfAPlatformThatMovesAreComparedAtOneTime) {
  const ScratchFolder folder;
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
    for (int i = 0; i <= 20; ++i) {
      const ros::Time stamp(10.0 + 0.5 * i);
      tf2_msgs::TFMessage frames;
      for (const char* name : {"a", "b"}) {
        SeenStation station(name, {10.0 * i, 0.0, 0.0}, 0.3, 1);
        frames.transforms.push_back(station.transform(stamp, "world"));
        if (i > 0 && i < 20 && (name[0] == 'a' || i > 10))
          bag.write(std::string("/") + name, stamp, station.scan(stamp, targetAt(0.0)));
      }
      bag.write("/tf", stamp, frames);
    }
  }
  const rosbag::Bag bag(folder.file("in.bag"));
  const RecordedStations found = recordedStationsOf(bag, "world");
  EXPECT_FALSE(found.standApart()) << found.apart;
}

/// Two sensors `apart` [m] on a frame "ship", which /tf or /tf_static leads to.
RecordedStations onAShip(double apart, bool moves) {
  const ScratchFolder folder;
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
    tf2_msgs::TFMessage mounts;
    for (const auto& [name, x] : {std::pair<const char*, double>{"a", 0.0}, {"b", apart}}) {
      SeenStation station(name, {x, 0.0, 0.0}, 0.3, 1);
      mounts.transforms.push_back(station.transform(ros::Time(10.0), "ship"));
      bag.write(std::string("/") + name, ros::Time(11.0), station.scan(ros::Time(11.0), targetAt(0.0)));
    }
    bag.write("/tf_static", ros::Time(10.0), mounts);
    for (int i = 0; i < 4; ++i) {
      tf2_msgs::TFMessage ship;
      ship.transforms.push_back(
          SeenStation("ship", {10.0 * i, 0.0, 0.0}, 0.3, 1).transform(ros::Time(10.0 + i), "world"));
      if (moves || i == 0) bag.write(moves ? "/tf" : "/tf_static", ros::Time(10.0 + i), ship);
    }
  }
  const rosbag::Bag bag(folder.file("in.bag"));
  return recordedStationsOf(bag, "world");
}

TEST(RecordedStations, SensorsMountedOnOnePlatformThatMovesAreOneStationUpToTenMetres) {
  const RecordedStations near = onAShip(3.0, true);
  EXPECT_FALSE(near.standApart()) << near.apart;
  EXPECT_EQ(near.stations.size(), 1u);
  EXPECT_TRUE(onAShip(30.0, true).standApart());
  EXPECT_TRUE(onAShip(3.0, false).standApart()) << "a frame that stands is no platform";
}

}  // namespace
