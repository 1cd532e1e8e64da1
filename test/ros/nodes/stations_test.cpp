// The field of four stations, launched as a user does: are its three drones where they are told to be, and is
// the table at the end in metres?
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>
#include <visualization_msgs/MarkerArray.h>

#include "support/launch.h"
#include "support/scratch_folder.h"

namespace {

constexpr double kPatience = 120.0;  // [s], for a launch of 15 s of data
constexpr double kNear = 1.0;        // [m]: sigmas are a decimetre

class Stations : public testing::Test {
 protected:
  static Eigen::Vector3d placeOf(const sightline::PositionTrack& track) {
    return {track.position.x, track.position.y, track.position.z};
  }

  /// Where the truth had its targets at the stamp, by id; empty when it has not come.
  std::map<std::uint32_t, Eigen::Vector3d> truthAt(const ros::Time& stamp) const {
    std::map<std::uint32_t, Eigen::Vector3d> places;
    auto after = truth_.lower_bound(stamp);
    if (after == truth_.begin() || after == truth_.end()) return places;
    const auto before = std::prev(after);
    const double share = (stamp - before->first).toSec() / (after->first - before->first).toSec();
    for (std::size_t i = 0; i < after->second.tracks.size(); ++i)
      places[after->second.tracks[i].id] =
          (1.0 - share) * placeOf(before->second.tracks.at(i)) + share * placeOf(after->second.tracks[i]);
    return places;
  }

  std::map<ros::Time, sightline::PositionTrackArray> truth_, positions_;
};

TEST_F(Stations, ThreeDronesHaveTheirPositionsAndTheTableIsInMetres) {
  ros::NodeHandle nh;
  std::size_t reports = 0, pictures = 0;
  const auto truth = nh.subscribe<sightline::PositionTrackArray>(
      "/truth/positions", 1000, [this](const sightline::PositionTrackArray::ConstPtr& message) {
        truth_[message->header.stamp] = *message;
      });
  const auto positions = nh.subscribe<sightline::PositionTrackArray>(
      "/positions/tracks", 1000, [this](const sightline::PositionTrackArray::ConstPtr& message) {
        positions_[message->header.stamp] = *message;
      });
  const auto report = nh.subscribe<sightline::PositionReport>(
      "/positions/report", 1000, [&](const sightline::PositionReport::ConstPtr&) { ++reports; });
  const auto picture = nh.subscribe<visualization_msgs::MarkerArray>(
      "/display/positions", 10, [&](const visualization_msgs::MarkerArray::ConstPtr& markers) {
        for (const auto& marker : markers->markers) pictures += marker.ns == "ellipsoids";
      });
  const ScratchFolder folder;
  {
    Launch launch("stations.launch", {"rviz:=false", "display:=true", "live:=false", "duration:=15",
                                      "table_file:=" + folder.file("table.txt")});
    ASSERT_TRUE(launch.endsWithin(kPatience)) << "the launch did not end by itself";
    EXPECT_EQ(*launch.exitCode(), 0);
  }
  EXPECT_GT(reports, 100u);
  XmlRpc::XmlRpcValue views;
  ASSERT_TRUE(nh.getParam("/position_tracker/fields_of_view", views));
  ASSERT_EQ(views.size(), 4);
  EXPECT_EQ(static_cast<std::string>(views[3]["tracker"]), "camera_4");
  EXPECT_EQ(static_cast<std::string>(views[3]["frame"]), "camera_4");
  EXPECT_GT(pictures, 10u);
  ASSERT_FALSE(truth_.empty());
  ASSERT_FALSE(positions_.empty());

  // In the last five seconds: of each report the positions of all three targets, and nothing else. A machine
  // that is busy ends the flight before all of its sightings are positions.
  const ros::Time from = std::min(truth_.rbegin()->first, positions_.rbegin()->first) - ros::Duration(5.0);
  std::size_t looked = 0, complete = 0, tracks = 0, good = 0;
  std::map<std::uint32_t, std::set<std::uint32_t>> ids;
  for (const auto& [stamp, array] : positions_) {
    const auto places = truthAt(stamp);
    if (stamp < from || places.empty()) continue;
    ++looked;
    std::set<std::uint32_t> found;
    for (const auto& track : array.tracks) {
      if (track.status != sightline::PositionTrack::CONFIRMED) continue;
      ++tracks;
      for (const auto& [target, place] : places) {
        if ((placeOf(track) - place).norm() > kNear) continue;
        ++good;
        found.insert(target);
        ids[target].insert(track.id);
        break;
      }
    }
    complete += found.size() == 3;
  }
  ASSERT_GT(looked, 50u);
  EXPECT_GT(static_cast<double>(complete), 0.95 * static_cast<double>(looked));
  EXPECT_GT(static_cast<double>(good), 0.98 * static_cast<double>(tracks)) << "ghosts";
  for (const auto& [target, of_target] : ids) EXPECT_EQ(of_target.size(), 1u) << "ids of target " << target;

  std::ifstream file(folder.file("table.txt"));
  const std::string table{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_NE(table.find("/positions/tracks"), std::string::npos) << table;
  EXPECT_NE(table.find("RMSE [m]"), std::string::npos) << table;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "stations_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
