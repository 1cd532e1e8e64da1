#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <ros/message_traits.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/sighting.h"
#include "sightline/ros/adapters/adapter_messages.h"

#include "fuzz/ros/random_messages.h"
#include "fuzz/ros/ros_targets.h"
#include "fuzz/text_mutations.h"

namespace sightline_fuzz {

namespace core = sightline::core;
using sightline_ros::AdapterTopic;
using sightline_ros::FieldMap;
using sightline_ros::PixelRays;
using sightline_ros::Reading;

namespace {

AdapterTopic randomTopic(RandomInput& input, AdapterTopic::Kind kind) {
  AdapterTopic topic;
  topic.kind = kind;
  topic.topic = "/in";
  topic.sensor = "camera";
  if (input.chance(0.3)) topic.frame = "mast";
  topic.is_optical = input.chance(0.3);
  topic.stamp_on_arrival = input.chance(0.3);
  topic.stamp_offset = input.oneOf({0.0, -0.25, -1e9});
  if (input.chance(0.7)) topic.sigma = Eigen::Vector2d(1e-3, 2e-3);
  if (input.chance(0.7)) topic.sigma_px = Eigen::Vector2d(0.5, 1.0);
  topic.zero_is_nothing = input.chance(0.3);
  topic.max_sightings = input.oneOf({1, 1000});
  return topic;
}

std::string randomPath(RandomInput& input, const std::vector<std::string>& paths) {
  const std::string path =
      paths[static_cast<std::size_t>(input.between(0, static_cast<int>(paths.size()) - 1))];
  return input.chance(0.02) ? mutated(input, path) : path;
}

void requireSoundScan(const Reading& reading, const AdapterTopic& topic) {
  const sightline_ros::AdaptedScan adapted = adapt(reading, topic, ros::Time(101, 0));
  if (!adapted.scan) {
    require(!adapted.refusals.empty(), "a message became no scan, and nothing says why");
    return;
  }
  require(!adapted.scan->header.frame_id.empty() && !adapted.scan->header.stamp.isZero(),
          "a scan has no frame or no stamp");
  require(adapted.scan->sightings.size() <= static_cast<std::size_t>(topic.max_sightings),
          "more sightings than max_sightings");
  for (const sightline::Sighting& sighting : adapted.scan->sightings) {
    Eigen::Matrix2d covariance;
    covariance << sighting.covariance[0], sighting.covariance[1], sighting.covariance[2],
        sighting.covariance[3];
    const auto refusal = core::rejectionOf({sighting.azimuth, sighting.elevation}, covariance);
    require(!refusal, "a sighting that trackers reject: " + (refusal ? refusal->detail : ""));
  }
}

/// One type of message that is read by field paths.
struct Sample {
  std::string type, definition;
  std::vector<std::uint8_t> bytes;
  std::string list;                  // an element for each sighting; empty = none
  std::vector<std::string> numbers;  // of an element, or of the message where there is no list
  std::vector<std::string> others;   // that are no numbers, no lists or not there
};

template <typename Message>
Sample sampleOf(const Message& message, const std::string& list, const std::vector<std::string>& numbers,
                const std::vector<std::string>& others) {
  return {ros::message_traits::datatype<Message>(),
          ros::message_traits::definition<Message>(),
          bytesOfMessage(message),
          list,
          numbers,
          others};
}

const std::vector<Sample>& fieldSamples() {
  static const std::vector<Sample> samples = [] {
    RandomInput input(1);
    sightline::TrackArray tracks;
    tracks.header.frame_id = "platform_enu";
    tracks.header.stamp = ros::Time(100, 0);
    tracks.tracks.resize(3);
    for (sightline::Track& track : tracks.tracks) track.sources = {"a", "bc"};
    nav_msgs::Odometry odometry;
    odometry.header = tracks.header;
    odometry.pose.pose = randomPose(input);
    geometry_msgs::PoseArray poses;
    poses.header = tracks.header;
    for (int k = 0; k < 4; ++k) poses.poses.push_back(randomPose(input));
    return std::vector<Sample>{
        sampleOf(tracks, "tracks",
                 {"azimuth", "elevation", "covariance[0]", "covariance[5]", "gate.azimuth", "gate/elevation",
                  "id", "existence"},
                 {"tracks", "header", "tracks[1].azimuth", "sources", "tracks.2.gate"}),
        sampleOf(odometry, "",
                 {"pose.pose.position.x", "pose/pose/position/y", "pose.pose.position.z",
                  "pose.covariance[35]", "pose.covariance[0]", "twist.twist.angular.z"},
                 {"header", "pose.covariance", "child_frame_id", "pose.covariance[36]"}),
        sampleOf(poses, "poses", {"position.x", "position.y", "position.z", "orientation.w"},
                 {"poses", "header", "poses[3].position.x", "orientation", "poses[99].position.x"}),
    };
  }();
  return samples;
}

/// Paths that the sample's message has, in the places where they belong.
void takeRealLists(RandomInput& input, const Sample& sample, FieldMap& fields) {
  fields.each = sample.list;
  fields.header = input.chance(0.8) ? "header" : "";
}

FieldMap randomFields(RandomInput& input, const std::vector<std::string>& paths) {
  FieldMap fields;
  fields.form = input.oneOf(
      {FieldMap::Form::angles, FieldMap::Form::point, FieldMap::Form::pixel, FieldMap::Form::corners});
  const int axes = fields.form == FieldMap::Form::point ? 3 : fields.form == FieldMap::Form::corners ? 4 : 2;
  // As the loader lets them be: the spread of all axes or of none, by sigma or by variance.
  const bool has_sigma = input.chance(0.2), has_variance = !has_sigma && input.chance(0.2);
  for (int axis = 0; axis < axes; ++axis) {
    sightline_ros::Quantity quantity;
    const bool may_be_left_out = fields.form == FieldMap::Form::angles && axis == 1;
    if (!may_be_left_out || input.chance(0.8)) quantity.field = randomPath(input, paths);
    quantity.scale = input.oneOf({1.0, core::kDegree, -1.0});
    if (has_sigma) quantity.sigma = randomPath(input, paths);
    if (has_variance) quantity.variance = randomPath(input, paths);
    fields.axes.push_back(quantity);
  }
  if (input.chance(0.3)) fields.snr = randomPath(input, paths);
  if (input.chance(0.6)) fields.each = randomPath(input, paths);
  if (input.chance(0.8)) fields.header = randomPath(input, paths);
  return fields;
}

sensor_msgs::CameraInfo soundCamera() {
  sensor_msgs::CameraInfo camera;
  camera.header.frame_id = "camera";
  camera.header.stamp = ros::Time(100, 0);
  camera.width = 640;
  camera.height = 480;
  camera.distortion_model = "plumb_bob";
  camera.K = {500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0};
  camera.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  camera.P = {500.0, 0.0, 320.0, 0.0, 0.0, 500.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return camera;
}

sensor_msgs::CameraInfo randomCamera(RandomInput& input) {
  sensor_msgs::CameraInfo camera = soundCamera();
  camera.header = randomHeader(input);
  camera.width = static_cast<std::uint32_t>(input.oneOf({640, 0, 1, -1}));
  camera.distortion_model =
      input.oneOf<const char*>({"plumb_bob", "equidistant", "rational_polynomial", "", "none"});
  for (int count = input.oneOf({0, 4, 5, 8, 3}); count > 0; --count)
    camera.D.push_back(input.chance(0.8) ? 0.1 * input.normal() : randomNumber(input));
  if (input.chance(0.3)) camera.K[static_cast<std::size_t>(input.between(0, 8))] = randomNumber(input);
  if (input.chance(0.2)) camera.R[static_cast<std::size_t>(input.between(0, 8))] = randomNumber(input);
  if (input.chance(0.3)) camera.P[static_cast<std::size_t>(input.between(0, 11))] = randomNumber(input);
  camera.binning_x = camera.binning_y = static_cast<std::uint32_t>(input.oneOf({0, 1, 2, -1}));
  if (input.chance(0.1)) camera.roi.x_offset = static_cast<std::uint32_t>(input.between(-1, 700));
  return camera;
}

sensor_msgs::PointCloud2 randomCloud(RandomInput& input) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header = randomHeader(input);
  cloud.width = static_cast<std::uint32_t>(input.oneOf({0, 1, 20, -1}));
  cloud.height = static_cast<std::uint32_t>(input.oneOf({1, 1, 0, -1}));
  cloud.point_step = static_cast<std::uint32_t>(input.oneOf({16, 16, 0, 12, -1}));
  cloud.row_step = static_cast<std::uint32_t>(input.oneOf({320, 320, 0, -1}));
  cloud.is_bigendian = static_cast<std::uint8_t>(input.chance(0.2));
  cloud.is_dense = static_cast<std::uint8_t>(input.chance(0.5));
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "snr"}) {
    if (input.chance(0.05)) continue;
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = input.chance(0.9) ? offset : static_cast<std::uint32_t>(input.oneOf({-1, 15, 1000}));
    field.datatype = static_cast<std::uint8_t>(input.chance(0.8) ? 7 : input.between(0, 9));
    field.count = static_cast<std::uint32_t>(input.oneOf({1, 1, 0, -1}));
    cloud.fields.push_back(field);
    offset += 4;
  }
  cloud.data.resize(static_cast<std::size_t>(input.oneOf({320, 320, 0, 319, 16})));
  for (std::uint8_t& byte : cloud.data) byte = static_cast<std::uint8_t>(input.between(0, 255));
  return cloud;
}

sensor_msgs::LaserScan randomSweep(RandomInput& input) {
  sensor_msgs::LaserScan sweep;
  sweep.header = randomHeader(input);
  sweep.angle_min = static_cast<float>(input.chance(0.9) ? -1.5 : randomNumber(input));
  sweep.angle_max = static_cast<float>(input.chance(0.9) ? 1.5 : randomNumber(input));
  sweep.angle_increment = static_cast<float>(input.chance(0.9) ? 0.03 : randomNumber(input));
  sweep.time_increment = static_cast<float>(input.chance(0.9) ? 1e-4 : randomNumber(input));
  sweep.range_min = static_cast<float>(input.chance(0.9) ? 0.1 : randomNumber(input));
  sweep.range_max = static_cast<float>(input.chance(0.9) ? 100.0 : randomNumber(input));
  for (int beam = input.oneOf({0, 1, 101}); beam > 0; --beam)
    sweep.ranges.push_back(
        static_cast<float>(input.chance(0.3) ? randomNumber(input) : 10.0 + 0.01 * input.normal()));
  return sweep;
}

template <typename Message>
void readOne(const Message& message, AdapterTopic::Kind kind, const PixelRays* rays, RandomInput& input,
             Trial& trial) {
  AdapterTopic topic = randomTopic(input, kind);
  if (kind == AdapterTopic::Kind::laser) topic.sigma = Eigen::Vector2d(1e-3, 2e-3);  // as the loader asks
  if (kind == AdapterTopic::Kind::cloud) {
    topic.fields = randomFields(input, {"x", "y", "z", "snr", "w"});
    topic.fields.each.clear();
  }
  trial.call("read", [&] { requireSoundScan(read(message, topic, rays), topic); });
}

}  // namespace

void fuzzAdapterFields(RandomInput& input, Trial& trial) {
  static const PixelRays rays(soundCamera(), false);
  for (int n = 20; n > 0; --n) {
    const Sample& sample = fieldSamples()[static_cast<std::size_t>(
        input.between(0, static_cast<int>(fieldSamples().size()) - 1))];
    AdapterTopic topic = randomTopic(input, AdapterTopic::Kind::fields);
    topic.type = sample.type;
    const bool is_real = input.chance(0.85);
    std::vector<std::string> paths = sample.numbers;
    if (!is_real) paths.insert(paths.end(), sample.others.begin(), sample.others.end());
    topic.fields = randomFields(input, paths);
    if (is_real) takeRealLists(input, sample, topic.fields);
    const std::string definition = input.chance(0.1) ? mutated(input, sample.definition) : sample.definition;
    std::vector<std::uint8_t> bytes = sample.bytes;
    if (input.chance(0.5)) spoil(input, bytes);
    trial.callThatRefuses<sightline_ros::FieldError>("read by fields", [&] {
      const sightline_ros::MessageLayout layout(sample.type, definition);
      requireSoundScan(read({bytes.data(), bytes.size()}, layout, topic, input.chance(0.9) ? &rays : nullptr),
                       topic);
    });
  }
}

void fuzzAdapterMessages(RandomInput& input, Trial& trial) {
  using Kind = AdapterTopic::Kind;
  std::optional<PixelRays> rays;
  const sensor_msgs::CameraInfo camera = randomCamera(input);
  const bool is_rectified = input.chance(0.3);
  trial.call("camera", [&] {
    if (!sightline_ros::refusalOf(camera, is_rectified)) rays.emplace(camera, is_rectified);
  });
  const PixelRays* camera_rays = rays ? &*rays : nullptr;
  for (int n = 4; n > 0; --n) {
    geometry_msgs::Vector3Stamped direction;
    direction.header = randomHeader(input);
    direction.vector.x = randomNumber(input);
    direction.vector.y = randomNumber(input);
    direction.vector.z = randomNumber(input);
    readOne(direction, Kind::direction, nullptr, input, trial);
    geometry_msgs::PointStamped point;
    point.header = direction.header;
    point.point = randomPose(input).position;
    readOne(point, Kind::point, nullptr, input, trial);
    readOne(point, Kind::pixel, camera_rays, input, trial);
    geometry_msgs::PoseArray poses;
    poses.header = direction.header;
    for (int k = input.between(0, 5); k > 0; --k) poses.poses.push_back(randomPose(input));
    readOne(poses, Kind::poses, nullptr, input, trial);
    geometry_msgs::PoseWithCovarianceStamped pose;
    pose.header = direction.header;
    pose.pose.pose = randomPose(input);
    for (double& variance : pose.pose.covariance) variance = input.chance(0.7) ? 0.0 : randomNumber(input);
    for (const std::size_t k : {0U, 7U, 14U})
      pose.pose.covariance[k] = input.chance(0.7) ? input.logBetween(1e-9, 1e9) : randomNumber(input);
    readOne(pose, Kind::pose_with_covariance, nullptr, input, trial);
    sensor_msgs::RegionOfInterest box;
    box.x_offset = static_cast<std::uint32_t>(input.between(-1, 700));
    box.y_offset = static_cast<std::uint32_t>(input.between(-1, 700));
    box.width = static_cast<std::uint32_t>(input.between(-1, 100));
    box.height = static_cast<std::uint32_t>(input.between(-1, 100));
    readOne(box, Kind::box, camera_rays, input, trial);
    readOne(randomCloud(input), Kind::cloud, camera_rays, input, trial);
    readOne(randomSweep(input), Kind::laser, nullptr, input, trial);
  }
}

}  // namespace sightline_fuzz
