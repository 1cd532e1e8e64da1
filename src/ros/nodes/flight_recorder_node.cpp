#include "sightline/ros/nodes/flight_recorder_node.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <ctime>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>
#include <std_msgs/String.h>

#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/replay_parameters.h"

namespace sightline_ros {
namespace {

namespace files = std::filesystem;

constexpr std::uint32_t kRecorderQueue = 10000;  // messages of a topic that wait to be kept
constexpr std::size_t kMostFoundTopics =
    1000;                                      // that are found; a list of ~topics may be as long as it likes
constexpr double kDiscoveryPeriod = 1.0;       // [s]
constexpr double kSavePeriod = 0.1;            // of looking for an incident whose save is due [s]
constexpr double kMegabyte = 1024.0 * 1024.0;  // [bytes]
const char* const kIncident = "incident";      // how the names of bags begin
const char* const kSaved = "saved";

/// folder/kind_2026-11-28_14-03-07.bag, with a number behind the time where that is taken.
files::path nameOfBag(const files::path& folder, const std::string& kind) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char time[32];
  std::strftime(time, sizeof time, "%Y-%m-%d_%H-%M-%S", &local);
  files::path path = folder / (kind + "_" + time + ".bag");
  for (int number = 2; files::exists(path); ++number)
    path = folder / (kind + "_" + time + "_" + std::to_string(number) + ".bag");
  return path;
}

std::string oneDecimal(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

}  // namespace

FlightRecorderParams loadFlightRecorderParams(const ParamReader& reader) {
  FlightRecorderParams params;
  params.seconds = reader.number("seconds", params.seconds, between(1.0, 3600.0), "s");
  params.max_megabytes = reader.number("max_megabytes", params.max_megabytes, between(1.0, 65536.0), "MB");
  params.folder = reader.text("folder", params.folder);
  params.topics = reader.texts("topics", params.topics);
  params.track_topics = reader.texts("track_topics", params.track_topics);
  params.report_topics = reader.texts("report_topics", params.report_topics);
  params.after = reader.number("after", params.after, between(0.0, 600.0), "s");
  params.min_interval = reader.number("min_interval", params.min_interval, between(0.0, 86400.0), "s");
  params.max_disk_megabytes =
      reader.number("max_disk_megabytes", params.max_disk_megabytes, between(1.0, 1e7), "MB");
  if (params.after >= params.seconds)
    throw reader.error("after", "must be less than ~seconds, or the incident is forgotten when it is saved");
  return params;
}

bool isOfTracking(const ros::master::TopicInfo& topic) {
  if (topic.datatype == "sightline/TrackSelection") return false;  // a replay would choose it again
  return topic.datatype.rfind("sightline/", 0) == 0 || topic.datatype == "tf2_msgs/TFMessage" ||
         topic.datatype == "dynamic_reconfigure/Config" || topic.name == "/diagnostics" ||
         (topic.datatype == "std_msgs/String" && isParameterTopic(topic.name));
}

FlightRecorderNode::FlightRecorderNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : nh_(nh),
      name_(nameOfNode(private_nh)),
      guard_(name_),
      params_([&private_nh] {
        const ParamReader reader(private_nh);
        FlightRecorderParams params = loadFlightRecorderParams(reader);
        reader.finish();
        return params;
      }()),
      ring_(params_.seconds, static_cast<std::size_t>(params_.max_megabytes * kMegabyte)) {
  files::create_directories(params_.folder);
  params_.folder = files::absolute(params_.folder).string();
  for (const std::string& topic : params_.topics) keep(nh_.resolveName(topic));
  if (params_.topics.empty()) {
    findTopics();
    discovery_ = nh_.createWallTimer(ros::WallDuration(kDiscoveryPeriod),
                                     guard_("a timer", [this](const ros::WallTimerEvent&) { findTopics(); }));
  }
  watch();
  diagnostics_.emplace(nh, private_nh, "flight recorder", [this](auto& status, double) { diagnose(status); });

  ros::NodeHandle saving(private_nh);
  saving.setCallbackQueue(&save_queue_);
  save_service_ = saving.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
      "save", [this](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& answer) {
        return onSaveRequest(answer);
      });
  save_timer_ = saving.createWallTimer(ros::WallDuration(kSavePeriod),
                                       [this](const ros::WallTimerEvent&) { saveIncident(); });
  save_spinner_.start();
}

FlightRecorderNode::~FlightRecorderNode() {
  save_spinner_.stop();
}

void FlightRecorderNode::findTopics() {
  ros::master::V_TopicInfo topics;
  if (!ros::master::getTopics(topics)) return;
  for (const ros::master::TopicInfo& topic : topics) {
    if (isOfTracking(topic) && kept_topics_.size() < kMostFoundTopics) keep(topic.name);
  }
}

void FlightRecorderNode::keep(const std::string& topic) {
  if (!kept_topics_.insert(topic).second) return;
  using Event = ros::MessageEvent<const topic_tools::ShapeShifter>;
  ros::SubscribeOptions options;
  options.topic = topic;
  options.queue_size = kRecorderQueue;
  options.md5sum = ros::message_traits::md5sum<topic_tools::ShapeShifter>();
  options.datatype = ros::message_traits::datatype<topic_tools::ShapeShifter>();
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  options.helper = boost::make_shared<ros::SubscriptionCallbackHelperT<const Event&>>(
      boost::function<void(const Event&)>(guard_(topic, [this, topic](const Event& event) {
        const std::lock_guard<std::mutex> lock(mutex_);
        ring_.add({topic, ros::Time::now(), event.getConstMessage(), event.getConnectionHeaderPtr()});
      })));
  subscribers_.push_back(nh_.subscribe(options));
}

void FlightRecorderNode::watch() {
  for (const std::string& topic : params_.track_topics) {
    const auto callback = [this, topic](const sightline::TrackArray::ConstPtr& tracks) {
      if (const auto what = watch_.onTracks(topic, *tracks)) onIncident(*what);
    };
    subscribers_.push_back(nh_.subscribe<sightline::TrackArray>(
        topic, kRecorderQueue,
        boost::function<void(const sightline::TrackArray::ConstPtr&)>(guard_(topic, callback))));
  }
  for (const std::string& topic : params_.report_topics) {
    const auto callback = [this](const sightline::FusionReport::ConstPtr& report) {
      if (const auto what = IncidentWatch::onReport(*report)) onIncident(*what);
    };
    subscribers_.push_back(nh_.subscribe<sightline::FusionReport>(
        topic, kRecorderQueue,
        boost::function<void(const sightline::FusionReport::ConstPtr&)>(guard_(topic, callback))));
  }
}

void FlightRecorderNode::onIncident(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::WallTime now = ros::WallTime::now();
  const bool is_soon = last_incident_ && (now - *last_incident_).toSec() < params_.min_interval;
  if (pending_ || is_soon) {
    ++passed_over_;
    return;
  }
  last_incident_ = now;
  pending_ = Incident{what, ros::Time::now(), now + ros::WallDuration(params_.after)};
}

void FlightRecorderNode::saveIncident() {
  std::optional<Incident> incident;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!pending_ || ros::WallTime::now() < pending_->due) return;
    incident = std::exchange(pending_, std::nullopt);
  }
  try {
    const std::string bag = save(kIncident, incident);
    ROS_INFO_STREAM(name_ << ": " << incident->what << ": saved " << bag);
  } catch (const std::exception& problem) {
    ROS_ERROR_STREAM(name_ << ": " << incident->what << ": not saved: " << problem.what());
  }
}

bool FlightRecorderNode::onSaveRequest(std_srvs::Trigger::Response& answer) {
  try {
    answer.message = save(kSaved, std::nullopt);
    answer.success = 1;
  } catch (const std::exception& problem) {
    answer.message = problem.what();
    answer.success = 0;
  }
  return true;
}

std::string FlightRecorderNode::save(const std::string& kind, const std::optional<Incident>& incident) {
  std::vector<RecordedMessage> messages;
  std::size_t bytes = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages = ring_.messages();
    bytes = ring_.bytes();
  }
  try {
    if (messages.empty()) throw std::runtime_error("nothing has been received yet: see ~topics");
    if (incident) makeRoomFor(bytes);
    std::string path = nameOfBag(params_.folder, kind).string();
    writeBag(path, {}, [&](rosbag::Bag& bag) {
      write(bag, messages);
      std_msgs::String reason;
      if (incident) reason.data = incident->what;
      if (incident) bag.write("/" + name_ + "/reason", std::max(incident->time, ros::TIME_MIN), reason);
    });
    const std::lock_guard<std::mutex> lock(mutex_);
    last_bag_ = path;
    last_failure_.clear();
    return path;
  } catch (const std::exception& problem) {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_failure_ = problem.what();
    throw;
  }
}

void FlightRecorderNode::makeRoomFor(std::size_t bytes) const {
  const double limit = params_.max_disk_megabytes * kMegabyte;
  std::vector<files::path> bags;  // of incidents: what somebody asked for is theirs
  for (const auto& entry : files::directory_iterator(params_.folder)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(std::string(kIncident) + "_", 0) == 0 && entry.path().extension() == ".bag")
      bags.push_back(entry.path());
  }
  std::sort(bags.begin(), bags.end());  // oldest first
  double sum = static_cast<double>(bytes);
  for (const files::path& bag : bags) sum += static_cast<double>(files::file_size(bag));
  for (std::size_t oldest = 0; sum > limit && oldest < bags.size(); ++oldest) {
    sum -= static_cast<double>(files::file_size(bags[oldest]));
    files::remove(bags[oldest]);
  }
  if (sum > limit)
    throw std::runtime_error("the bag would take " + oneDecimal(sum / kMegabyte) +
                             " MB, ~max_disk_megabytes is " + oneDecimal(params_.max_disk_megabytes) +
                             ": raise it, or lower ~max_megabytes");
}

void FlightRecorderNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string span = oneDecimal(ring_.span());
  status.summary(DiagnosticStatus::OK, "holds the last " + span + " s");
  if (ring_.size() == 0) status.summary(DiagnosticStatus::WARN, "nothing is received: see ~topics");
  if (ring_.crowdedOut() > crowded_out_before_)
    status.summary(DiagnosticStatus::WARN,
                   "holds " + span + " s of " + oneDecimal(params_.seconds) + " s: raise ~max_megabytes");
  if (!last_failure_.empty()) status.summary(DiagnosticStatus::ERROR, "not saved: " + last_failure_);
  crowded_out_before_ = ring_.crowdedOut();
  status.add("topics", kept_topics_.size());
  status.add("messages", ring_.size());
  status.add("memory [MB]", oneDecimal(static_cast<double>(ring_.bytes()) / kMegabyte));
  status.add("messages dropped for want of memory", ring_.crowdedOut());
  status.add("incidents too soon after another to be saved", passed_over_);
  status.add("last bag", last_bag_.empty() ? "none" : last_bag_);
  guard_.diagnose(status);
}

}  // namespace sightline_ros
