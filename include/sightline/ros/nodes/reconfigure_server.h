#pragma once

#include <cstdint>
#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <string>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_server.h>

#include "sightline/ros/params/reconfiguration.h"

namespace sightline_ros {

/// The values as dynamic_reconfigure has them, by key.
dynamic_reconfigure::Config configOf(const std::vector<ReadParam>& params);

/// Types, limits, defaults and descriptions for those who show or ask for values. An end of a range that does
/// not belong to it is given as if it did: the value there is refused when it is asked for.
dynamic_reconfigure::ConfigDescription descriptionOf(const Reconfiguration& reconfiguration);

/// What dynamic_reconfigure's clients (dynparam, rqt_reconfigure, Python) speak to, by its messages:
/// `~set_parameters`, `~parameter_descriptions` and `~parameter_updates` (latched; it tells a recording what
/// changed when). A wish is fulfilled as a whole or not at all; the answer holds the values in force. What
/// changed is said in the log and set on the parameter server; what was refused is said in the log. Requests
/// come on the queue of the node handle, between two messages of the node.
class ReconfigureServer {
 public:
  ReconfigureServer(const ros::NodeHandle& pnh, Reconfiguration reconfiguration);

  ReconfigureServer(const ReconfigureServer&) = delete;
  ReconfigureServer& operator=(const ReconfigureServer&) = delete;

  /// Adds a value for each parameter that is not as it was at the start, and what was refused last.
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  bool onRequest(dynamic_reconfigure::Reconfigure::Request& request,
                 dynamic_reconfigure::Reconfigure::Response& answer);
  void publish();

  ros::NodeHandle pnh_;
  Reconfiguration reconfiguration_;
  std::vector<ReadParam> at_start_;
  std::uint64_t refused_ = 0;
  std::string last_refusal_;
  ros::Publisher descriptions_;
  ros::Publisher updates_;
  ros::ServiceServer service_;
};

}  // namespace sightline_ros
