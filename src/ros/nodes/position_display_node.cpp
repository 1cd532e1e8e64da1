#include "sightline/ros/nodes/position_display_node.h"

#include <algorithm>

#include <Eigen/Geometry>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/station_pose.h"
#include "sightline/ros/messages/transform_messages.h"
#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/nodes/track_display_node.h"
#include "sightline/ros/params/scenario_params.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

}  // namespace

PositionDisplayParams::PositionDisplayParams() {
  for (const char* station : {"1", "2", "3", "4"}) {
    const std::string space = std::string("/sensors/camera_") + station;
    sighting_topics.push_back(space + "/sightings");
    track_topics.push_back(space + "/tracks");
  }
}

PositionDisplayParams loadPositionDisplayParams(const ParamReader& reader) {
  PositionDisplayParams params;
  PositionPictureParams& picture = params.picture;
  picture.frame = reader.text("tracking_frame", picture.frame);
  if (picture.frame.empty()) throw reader.error("tracking_frame", "expected the name of a frame, got \"\"");
  params.rate = reader.number("rate", params.rate, between(0.5, 60.0), "Hz");
  picture.size = reader.number("size", picture.size, atLeast(0.0), "m");
  picture.sighting_time = reader.number("sighting_time", picture.sighting_time, between(0.05, 60.0), "s");
  picture.history = reader.number("history", picture.history, between(0.1, 600.0), "s");
  picture.prediction = reader.number("prediction", picture.prediction, between(0.0, 60.0), "s");
  picture.silence = reader.number("silence", picture.silence, between(0.1, 60.0), "s");
  picture.lifetime = ros::Duration(std::max(0.5, 3.0 / params.rate));
  params.position_topic = reader.text("position_topic", params.position_topic);
  params.report_topic = reader.text("report_topic", params.report_topic);
  params.truth_topic = reader.text("truth_topic", params.truth_topic);
  params.sighting_topics = reader.texts("sighting_topics", params.sighting_topics);
  params.track_topics = reader.texts("track_topics", params.track_topics);
  params.scenario = reader.text("scenario", params.scenario);
  params.fields_of_view = loadFieldsOfView(reader);
  params.view_frame = reader.text("view_frame", params.view_frame);
  return params;
}

PositionDisplayNode::PositionDisplayNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : nh_(nh),
      guard_(nameOfNode(private_nh)),
      params_([&private_nh] {
        const ParamReader reader(private_nh);
        PositionDisplayParams params = loadPositionDisplayParams(reader);
        reader.finish();
        return params;
      }()),
      picture_(params_.picture, SensorColours(channelsOf(params_.sighting_topics, params_.track_topics))),
      transform_subscriber_(nh_, transforms_, [] {}) {
  loadScenarioThere();
  subscribe();
  publish_timer_ = nh_.createWallTimer(ros::WallDuration(1.0 / params_.rate),
                                       guard_("a timer", [this](const ros::WallTimerEvent&) { publish(); }));
  static_timer_ =
      nh_.createWallTimer(ros::WallDuration(kStaticPeriod),
                          guard_("a timer", [this](const ros::WallTimerEvent&) { repeatWhatStays(); }));
  diagnostics_.emplace(nh, private_nh, "display", [this](auto& status, double) {
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, "shows what comes");
    guard_.diagnose(status);
  });
}

/// Fields of view and obstacles of a simulated scenario, where there is one.
void PositionDisplayNode::loadScenarioThere() {
  if (params_.scenario.empty() || !nh_.hasParam(params_.scenario)) return;
  const core::Scenario scenario = loadScenario(ParamReader(ros::NodeHandle(nh_, params_.scenario)));
  for (FieldOfView& view : fieldsOfView(scenario)) params_.fields_of_view.push_back(std::move(view));
  picture_.setObstacles(scenario.obstacles);
}

template <typename Message, typename Callback>
void PositionDisplayNode::listen(const std::string& topic, Callback callback) {
  if (topic.empty()) return;
  subscribers_.push_back(nh_.subscribe<Message>(
      topic, kDisplayQueue, boost::function<void(const typename Message::ConstPtr&)>(guard_(topic, callback)),
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
}

void PositionDisplayNode::subscribe() {
  for (const std::string& topic : params_.sighting_topics)
    listen<sightline::SightingArray>(
        topic, [this](const sightline::SightingArray::ConstPtr& scan) { onScan(*scan); });
  for (const std::string& topic : params_.track_topics)
    listen<sightline::TrackArray>(
        topic, [this](const sightline::TrackArray::ConstPtr& tracks) { onTracks(*tracks); });
  using sightline::PositionTrackArray;
  listen<PositionTrackArray>(params_.position_topic, [this](const PositionTrackArray::ConstPtr& positions) {
    if (isInFrame(positions->header.frame_id, params_.position_topic))
      picture_.addPositions(*positions, ros::Time::now().toSec());
  });
  listen<sightline::PositionReport>(params_.report_topic,
                                    [this](const sightline::PositionReport::ConstPtr& report) {
                                      if (isInFrame(report->header.frame_id, params_.report_topic))
                                        picture_.addReport(*report, ros::Time::now().toSec());
                                    });
  listen<PositionTrackArray>(params_.truth_topic, [this](const PositionTrackArray::ConstPtr& truth) {
    if (isInFrame(truth->header.frame_id, params_.truth_topic))
      picture_.addTruth(*truth, ros::Time::now().toSec());
  });
}

void PositionDisplayNode::onScan(const sightline::SightingArray& scan) {
  const auto place = placeOf(scan.header.frame_id);
  if (!place) return;
  std::vector<Eigen::Vector3d> directions;
  for (const sightline::Sighting& sighting : scan.sightings)
    directions.push_back(place->R_metric_station * core::directionOf({sighting.azimuth, sighting.elevation}));
  picture_.addSightings(scan.sensor, place->origin, directions, ros::Time::now().toSec());
}

void PositionDisplayNode::onTracks(const sightline::TrackArray& tracks) {
  if (const auto place = placeOf(tracks.header.frame_id))
    picture_.addTracks(tracks, *place, ros::Time::now().toSec());
}

/// The newest place of a frame: a picture need not wait for that of a stamp.
std::optional<core::StationPose> PositionDisplayNode::placeOf(const std::string& frame) const {
  if (!transforms_.canTransform(params_.picture.frame, frame, ros::Time(0))) {
    ROS_WARN_STREAM_THROTTLE(kSecondsBetweenNotes, "Not showing what comes in frame \""
                                                       << frame << "\": tf does not lead from it to \""
                                                       << params_.picture.frame << "\"");
    return std::nullopt;
  }
  return poseOf(frame, ros::Time(0), params_.picture.frame, transforms_);
}

bool PositionDisplayNode::isInFrame(const std::string& frame, const std::string& of) const {
  if (frame == params_.picture.frame) return true;
  ROS_WARN_STREAM_THROTTLE(kSecondsBetweenNotes,
                           "Not showing " << of << ": its frame is '" << frame << "', the display's is '"
                                          << params_.picture.frame << "' (~tracking_frame)");
  return false;
}

void PositionDisplayNode::publish() {
  std::vector<StationView> stations;
  for (const FieldOfView& view : params_.fields_of_view) {
    if (!transforms_.canTransform(params_.picture.frame, view.frame, ros::Time(0))) continue;
    const core::StationPose pose = poseOf(view.frame, ros::Time(0), params_.picture.frame, transforms_);
    stations.push_back({view.sensor, pose.origin, pose.R_metric_station, view.half_width});
  }
  picture_.setStations(std::move(stations));
  for (const auto& [channel, markers] : picture_.draw(ros::Time::now().toSec())) {
    const auto [publisher, is_new] = publishers_.try_emplace(channel);
    if (is_new) publisher->second = nh_.advertise<MarkerArray>("/display/" + channel, 10);
    publisher->second.publish(markers);
  }
}

/// Between the stations, as wide as they stand apart, for a camera to look at.
void PositionDisplayNode::repeatWhatStays() {
  if (params_.view_frame.empty()) return;
  view_broadcaster_.sendTransform(transformMessage(ros::Time::now(), params_.picture.frame,
                                                   params_.view_frame, picture_.middle(),
                                                   Eigen::Matrix3d::Identity()));
}

}  // namespace sightline_ros
