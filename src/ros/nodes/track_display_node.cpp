#include "sightline/ros/nodes/track_display_node.h"

#include <algorithm>
#include <cctype>
#include <iterator>

#include <Eigen/Geometry>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <geometry_msgs/TransformStamped.h>
#include <ros/ros.h>
#include <sightline/TrackSelection.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/clock.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/params/scenario_params.h"

namespace sightline_ros {
namespace {

std::vector<std::string> sixSensors() {
  return {"acquisition_1", "acquisition_2", "acquisition_3", "tracking_1", "tracking_2", "tracking_3"};
}

std::vector<std::string> topicsOf(const std::vector<std::string>& sensors, const std::string& last) {
  std::vector<std::string> topics;
  for (const std::string& sensor : sensors) topics.push_back("/sensors/" + sensor + "/" + last);
  return topics;
}

/// Without the last part: "/sensors/left/tracks" -> "/sensors/left".
std::string namespaceOf(const std::string& topic) {
  const std::size_t last = topic.find_last_of('/');
  return last == std::string::npos ? "" : topic.substr(0, last);
}

/// A topic name made of what a topic name may hold.
std::string topicOfChannel(const std::string& channel) {
  std::string topic = "/display/" + channel;
  for (char& letter : topic) {
    const bool allowed =
        std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_' || letter == '/';
    if (!allowed) letter = '_';
  }
  return topic;
}

}  // namespace

TrackDisplayParams::TrackDisplayParams()
    : sighting_topics(topicsOf(sixSensors(), "sightings")),
      track_topics(topicsOf(sixSensors(), "tracks")),
      association_topics(topicsOf(sixSensors(), "associations")) {
  for (const char* group : {"/groups/acquisition/", "/groups/tracking/", "/sensor_fusion/"}) {
    track_topics.push_back(std::string(group) + "tracks");
    association_topics.push_back(std::string(group) + "associations");
  }
}

TrackDisplayParams loadTrackDisplayParams(const ParamReader& reader) {
  TrackDisplayParams params;
  Canvas& canvas = params.scene.canvas;
  params.frames = loadFrameChangeParams(reader, params.frames);
  canvas.frame = params.frames.tracking_frame;
  canvas.radius = reader.number("radius", canvas.radius, above(0.0), "m");
  params.rate = reader.number("rate", params.rate, between(0.5, 60.0), "Hz");
  params.scene.sighting_time =
      reader.number("sighting_time", params.scene.sighting_time, between(0.05, 60.0), "s");
  params.scene.history = reader.number("history", params.scene.history, between(0.1, 600.0), "s");
  params.scene.prediction = reader.number("prediction", params.scene.prediction, between(0.0, 60.0), "s");
  params.scene.tentative_gates = reader.flag("tentative_gates", params.scene.tentative_gates);
  params.scene.silence = reader.number("silence", params.scene.silence, between(0.1, 60.0), "s");
  params.main_topic = reader.text("main_topic", params.main_topic);
  params.truth_topic = reader.text("truth_topic", params.truth_topic);
  params.sighting_topics = reader.texts("sighting_topics", params.sighting_topics);
  params.track_topics = reader.texts("track_topics", params.track_topics);
  params.association_topics = reader.texts("association_topics", params.association_topics);
  params.selection_topic = reader.text("selection_topic", params.selection_topic);
  params.view_frame = reader.text("view_frame", params.view_frame);
  params.scenario = reader.text("scenario", params.scenario);
  params.fields_of_view = loadFieldsOfView(reader);
  canvas.lifetime = ros::Duration(std::max(0.5, 3.0 / params.rate));
  return params;
}

std::vector<FieldOfView> loadFieldsOfView(const ParamReader& reader) {
  std::vector<FieldOfView> views;
  for (const ParamReader& entry : reader.list("fields_of_view")) {
    FieldOfView view;
    view.sensor = entry.requiredText("sensor");
    view.frame = entry.text("frame", view.sensor);
    view.half_width.x() =
        entry.requiredNumber("azimuth_half_width", between(0.0, sightline::core::kPi), "rad");
    view.half_width.y() =
        entry.requiredNumber("elevation_half_width", between(0.0, sightline::core::kPi / 2.0), "rad");
    views.push_back(view);
  }
  return views;
}

std::vector<FieldOfView> fieldsOfView(const sightline::core::Scenario& scenario) {
  std::vector<FieldOfView> views;
  for (const sightline::core::SimulatedSensor& sensor : scenario.sensors) {
    views.push_back({sensor.name, sensor.name, sensor.field_of_view});
  }
  return views;
}

std::string channelOf(const std::string& topic) {
  const std::size_t last = topic.find_last_of('/');
  if (last == std::string::npos || last == 0) return topic.substr(last == 0 ? 1 : 0);
  const std::size_t before = topic.find_last_of('/', last - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return topic.substr(begin, last - begin);
}

std::vector<std::string> channelsOf(const std::vector<std::string>& sighting_topics,
                                    const std::vector<std::string>& track_topics) {
  std::vector<std::string> channels;
  for (const auto* topics : {&sighting_topics, &track_topics}) {
    for (const std::string& topic : *topics) {
      const std::string channel = channelOf(topic);
      if (std::find(channels.begin(), channels.end(), channel) == channels.end()) channels.push_back(channel);
    }
  }
  return channels;
}

TrackDisplayNode::TrackDisplayNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : nh_(nh),
      guard_(nameOfNode(private_nh)),
      params_([&private_nh] {
        const ParamReader reader(private_nh);
        TrackDisplayParams params = loadTrackDisplayParams(reader);
        reader.finish();
        return params;
      }()),
      colours_(channelsOf(params_.sighting_topics, params_.track_topics)),
      scene_(params_.scene, colours_),
      transform_subscriber_(nh_, transforms_, [] {}),
      frame_change_(params_.frames, transforms_) {
  if (!params_.scenario.empty() && nh_.hasParam(params_.scenario)) {
    const ParamReader reader{ros::NodeHandle(nh_, params_.scenario)};
    for (FieldOfView& view : fieldsOfView(loadScenario(reader)))
      params_.fields_of_view.push_back(std::move(view));
  }
  grid_publisher_ = nh_.advertise<MarkerArray>("/display/grid", 1, true);
  all_publisher_ = nh_.advertise<MarkerArray>("/display/all", 100);
  grid_publisher_.publish(gridMarkers(params_.scene.canvas));
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

template <typename Message, typename Callback>
void TrackDisplayNode::listen(const std::string& topic, Callback callback) {
  if (topic.empty()) return;
  subscribers_.push_back(nh_.subscribe<Message>(
      topic, kDisplayQueue, boost::function<void(const typename Message::ConstPtr&)>(guard_(topic, callback)),
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
}

void TrackDisplayNode::subscribe() {
  for (const std::string& topic : params_.sighting_topics) {
    listen<sightline::SightingArray>(topic, [this](const sightline::SightingArray::ConstPtr& scan) {
      frame_change_.add(scan, clockNow());
    });
  }
  listenToTracks(params_.main_topic, DisplayScene::kMainChannel);
  for (const std::string& topic : params_.track_topics) {
    if (topic != params_.main_topic) listenToTracks(topic, channelOf(topic));
  }
  for (const std::string& topic : params_.association_topics) {
    const bool of_main = namespaceOf(topic) == namespaceOf(params_.main_topic);
    const std::string channel = of_main ? DisplayScene::kMainChannel : channelOf(topic);
    listen<sightline::AssociationArray>(
        topic, [this, channel](const sightline::AssociationArray::ConstPtr& decisions) {
          scene_.addAssociations(channel, *decisions);
        });
  }
  listen<sightline::TrackSelection>(
      params_.selection_topic, [this](const sightline::TrackSelection::ConstPtr& choice) {
        std::optional<LookedAt> track;
        if (choice->track > 0)
          track = LookedAt{channelShowing(choice->topic), choice->track, choice->alone != 0};
        scene_.lookAt(track);
      });
  listen<sightline::TrackArray>(params_.truth_topic, [this](const sightline::TrackArray::ConstPtr& truth) {
    if (isInTrackingFrame(truth->header, "truth")) scene_.addTruth(*truth, ros::Time::now().toSec());
  });
}

std::string TrackDisplayNode::channelShowing(const std::string& track_topic) const {
  return track_topic == params_.main_topic ? DisplayScene::kMainChannel : channelOf(track_topic);
}

void TrackDisplayNode::listenToTracks(const std::string& topic, const std::string& channel) {
  listen<sightline::TrackArray>(topic, [this, channel](const sightline::TrackArray::ConstPtr& tracks) {
    if (isInTrackingFrame(tracks->header, channel))
      scene_.addTracks(channel, *tracks, ros::Time::now().toSec());
  });
}

bool TrackDisplayNode::isInTrackingFrame(const std_msgs::Header& header, const std::string& of) const {
  if (header.frame_id == params_.frames.tracking_frame) return true;
  ROS_WARN_STREAM_THROTTLE(5.0, "Not showing the tracks of "
                                    << of << ": their frame is '" << header.frame_id
                                    << "', the display's is '" << params_.frames.tracking_frame
                                    << "' (set ~tracking_frame of both to the same)");
  return false;
}

void TrackDisplayNode::showScans() {
  const ros::Time now = ros::Time::now();
  for (const FramedScan& framed : frame_change_.release(toCore(now))) {
    if (!framed.refusal) {
      scene_.addScan(framed.scan, now.toSec());
    } else {
      ROS_WARN_STREAM_THROTTLE(5.0, "Not showing a scan: " << framed.refusal->detail);
    }
  }
}

void TrackDisplayNode::publish() {
  showScans();
  for (const auto& [channel, markers] : scene_.draw(ros::Time::now().toSec())) {
    publish(channel, markers);
  }
  aimView();
}

void TrackDisplayNode::publish(const std::string& channel, const MarkerArray& markers) {
  publisherOf(channel).publish(markers);
  if (all_publisher_.getNumSubscribers() == 0) return;
  MarkerArray all = markers;
  for (Marker& marker : all.markers) marker.ns = channel + ": " + marker.ns;
  all_publisher_.publish(all);
}

void TrackDisplayNode::aimView() {
  const Eigen::Vector2d view = scene_.view();
  if (params_.view_frame.empty() || aimed_ == view) return;
  aimed_ = view;
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time::now();
  transform.header.frame_id = params_.frames.tracking_frame;
  transform.child_frame_id = params_.view_frame;
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(view.x(), Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(-view.y(), Eigen::Vector3d::UnitY());
  transform.transform.rotation.x = turn.x();
  transform.transform.rotation.y = turn.y();
  transform.transform.rotation.z = turn.z();
  transform.transform.rotation.w = turn.w();
  view_broadcaster_.sendTransform(transform);
}

/// rviz forgets all markers when simulated time goes back, as of a recording that begins again.
void TrackDisplayNode::repeatWhatStays() {
  grid_publisher_.publish(gridMarkers(params_.scene.canvas));
  publishFieldsOfView();
  aimed_.reset();  // of the latched transforms of a process only the last is kept: another nodelet's, maybe
  aimView();
}

/// Those of sensors whose frame is there: rviz shows an error for the others, which need not run.
void TrackDisplayNode::publishFieldsOfView() {
  std::vector<FieldOfView> views;
  const auto is_here = [this](const FieldOfView& view) {
    return transforms_.canTransform(params_.frames.tracking_frame, view.frame, ros::Time(0));
  };
  std::copy_if(params_.fields_of_view.begin(), params_.fields_of_view.end(), std::back_inserter(views),
               is_here);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Place place{i, views.size()};
    publish(views[i].sensor,
            fieldOfViewMarkers(params_.scene.canvas, views[i], place, colours_.of(views[i].sensor)));
  }
}

ros::Publisher& TrackDisplayNode::publisherOf(const std::string& channel) {
  const auto known = publishers_.find(channel);
  if (known != publishers_.end()) return known->second;
  return publishers_[channel] = nh_.advertise<MarkerArray>(topicOfChannel(channel), 10);
}

}  // namespace sightline_ros
