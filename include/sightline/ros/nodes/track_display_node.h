#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <sightline/AssociationArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "sightline/core/simulation/scenario.h"
#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"
#include "sightline/ros/display/display_scene.h"
#include "sightline/ros/messages/frames.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Parameters of `track_display`; the file config/track_display.yaml explains them.
struct TrackDisplayParams {
  DisplayParams scene;
  double rate = 15.0;  ///< [Hz]
  FrameChangeParams frames;
  std::string main_topic = "/fusion/tracks";
  std::string truth_topic = "/truth";
  std::vector<std::string> sighting_topics;
  std::vector<std::string> track_topics;
  std::vector<std::string> association_topics;
  std::string selection_topic = "/display/selection";  ///< TrackSelection; empty = none
  std::string scenario = "/scenario";  ///< parameters in which simulated sensors stand; need not be there
  std::vector<FieldOfView> fields_of_view;  ///< of other sensors
  std::string view_frame = "display_view";  ///< empty = none

  TrackDisplayParams();  ///< the topics of the six-sensor platform
};

/// Throws ParamError.
TrackDisplayParams loadTrackDisplayParams(const ParamReader& reader);

/// The list `fields_of_view` of sensors that no scenario knows. Throws ParamError.
std::vector<FieldOfView> loadFieldsOfView(const ParamReader& reader);

/// What the sensors of a scenario see.
std::vector<FieldOfView> fieldsOfView(const sightline::core::Scenario& scenario);

/// The name under which the things of a topic are shown: of the namespace that it stands in
/// ("/sensors/left/tracks" -> "left").
std::string channelOf(const std::string& topic);

/// The names of all topics, each once, in their order, which colours follow.
std::vector<std::string> channelsOf(const std::vector<std::string>& sighting_topics,
                                    const std::vector<std::string>& track_topics);

/// Shows sightings, tracks, gates and truth in rviz: MarkerArrays on /display/<sensor or tracker>,
/// /display/fusion, /display/truth, /display/magnifier and /display/grid, at a bounded rate whatever comes
/// in.
class TrackDisplayNode {
 public:
  TrackDisplayNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);

 private:
  void subscribe();
  std::string channelShowing(const std::string& track_topic) const;
  void listenToTracks(const std::string& topic, const std::string& channel);
  template <typename Message, typename Callback>
  void listen(const std::string& topic, Callback callback);

  bool isInTrackingFrame(const std_msgs::Header& header, const std::string& of) const;
  void showScans();

  void publish();
  void repeatWhatStays();
  void publishFieldsOfView();
  void publish(const std::string& channel, const MarkerArray& markers);
  void aimView();
  ros::Publisher& publisherOf(const std::string& channel);

  ros::NodeHandle nh_;
  CallbackGuard guard_;
  TrackDisplayParams params_;
  SensorColours colours_;
  DisplayScene scene_;
  tf2::BufferCore transforms_;
  TransformSubscriber transform_subscriber_;
  FrameChange frame_change_;
  std::vector<ros::Subscriber> subscribers_;
  std::map<std::string, ros::Publisher> publishers_;
  ros::Publisher grid_publisher_;
  ros::Publisher all_publisher_;
  tf2_ros::StaticTransformBroadcaster view_broadcaster_;
  std::optional<Eigen::Vector2d> aimed_;  // (azimuth, elevation) of the view frame that was published [rad]
  ros::WallTimer publish_timer_;
  ros::WallTimer static_timer_;
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
