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

}  // namespace
