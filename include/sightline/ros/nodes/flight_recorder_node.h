#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <std_srvs/Trigger.h>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/master.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>

#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/recordings/incident_watch.h"
#include "sightline/ros/recordings/message_ring.h"

namespace sightline_ros {

/// Parameters of `flight_recorder`; the file config/flight_recorder.yaml explains them.
struct FlightRecorderParams {
  double seconds = 60.0;         ///< that are kept [s]
  double max_megabytes = 256.0;  ///< of memory
  std::string folder = "flight_records";
  std::vector<std::string> topics;  ///< empty: those of `isOfTracking`
  std::vector<std::string> track_topics = {"/fusion/tracks"};
  std::vector<std::string> report_topics = {"/fusion/report"};
  double after = 5.0;                  ///< [s] from an incident to the save
  double min_interval = 60.0;          ///< [s] between two saves of incidents
  double max_disk_megabytes = 2000.0;  ///< of the bags of incidents in the folder
};

/// Throws ParamError.
FlightRecorderParams loadFlightRecorderParams(const ParamReader& reader);

/// Whether a topic is kept when none is named: messages of this package, tf, parameters that change in flight
/// and /diagnostics.
bool isOfTracking(const ros::master::TopicInfo& topic);

/// Keeps the last minute of what trackers see, decide and say, in bounded memory, and saves it to a bag: when
/// ~save (std_srvs/Trigger) is called, and of itself when a believed track ends or a sensor's verdict
/// changes. Saving does not hold up receiving.
class FlightRecorderNode {
 public:
  FlightRecorderNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);
  ~FlightRecorderNode();

 private:
  struct Incident {
    std::string what;
    ros::Time time;
    ros::WallTime due;  // of its save
  };

  void findTopics();
  void keep(const std::string& topic);
  void watch();
  void onIncident(const std::string& what);

  // In the thread that saves:
  bool onSaveRequest(std_srvs::Trigger::Response& answer);
  void saveIncident();
  std::string save(const std::string& kind, const std::optional<Incident>& incident);
  void makeRoomFor(std::size_t bytes) const;

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_;
  std::string name_;
  CallbackGuard guard_;
  FlightRecorderParams params_;
  std::set<std::string> kept_topics_;
  std::vector<ros::Subscriber> subscribers_;
  ros::WallTimer discovery_;
  IncidentWatch watch_;

  std::mutex mutex_;  // of everything down to the next empty line, which the two threads share
  MessageRing ring_;
  std::optional<Incident> pending_;
  std::optional<ros::WallTime> last_incident_;
  std::size_t passed_over_ = 0;  // incidents that came too soon after another to be saved
  std::string last_bag_, last_failure_;

  std::uint64_t crowded_out_before_ = 0;  // at the last diagnosis
  std::optional<PeriodicDiagnostics> diagnostics_;
  ros::CallbackQueue save_queue_;
  ros::ServiceServer save_service_;
  ros::WallTimer save_timer_;
  ros::AsyncSpinner save_spinner_{1, &save_queue_};
};

}  // namespace sightline_ros
