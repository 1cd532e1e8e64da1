#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <tf2/buffer_core.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"
#include "sightline/ros/display/markers.h"
#include "sightline/ros/display/position_picture.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Parameters of `position_display`; the file config/position_display.yaml explains them.
struct PositionDisplayParams {
  PositionPictureParams picture;
  double rate = 15.0;  ///< [Hz]
  std::string position_topic = "/positions/tracks";
  std::string report_topic = "/positions/report";
  std::string truth_topic = "/truth/positions";
  std::vector<std::string> sighting_topics;
  std::vector<std::string> track_topics;
  std::string scenario = "/scenario";  ///< parameters in which simulated sensors stand; need not be there
  std::vector<FieldOfView> fields_of_view;    ///< of other sensors
  std::string view_frame = "positions_view";  ///< between the stations; empty = none

  PositionDisplayParams();  ///< the topics of stations.launch
};

/// Throws ParamError.
PositionDisplayParams loadPositionDisplayParams(const ParamReader& reader);

/// Shows stations, rays, positions and refused crossings in rviz: MarkerArrays on /display/stations,
/// /display/rays, /display/positions, /display/refused_crossings and /display/true_positions, at a bounded
/// rate whatever comes in.
class PositionDisplayNode {
 public:
  PositionDisplayNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);

 private:
  void loadScenarioThere();
  void subscribe();
  template <typename Message, typename Callback>
  void listen(const std::string& topic, Callback callback);
  void onScan(const sightline::SightingArray& scan);
  void onTracks(const sightline::TrackArray& tracks);

  std::optional<sightline::core::StationPose> placeOf(const std::string& frame) const;
  bool isInFrame(const std::string& frame, const std::string& of) const;
  void publish();
  void repeatWhatStays();

  ros::NodeHandle nh_;
  CallbackGuard guard_;
  PositionDisplayParams params_;
  PositionPicture picture_;
  tf2::BufferCore transforms_;
  TransformSubscriber transform_subscriber_;
  std::vector<ros::Subscriber> subscribers_;
  std::map<std::string, ros::Publisher> publishers_;
  tf2_ros::StaticTransformBroadcaster view_broadcaster_;
  ros::WallTimer publish_timer_, static_timer_;
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
