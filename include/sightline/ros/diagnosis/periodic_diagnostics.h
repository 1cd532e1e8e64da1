#pragma once

#include <functional>
#include <optional>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/time.h>
#include <ros/wall_timer.h>

namespace sightline_ros {

/// Publishes a node's /diagnostics once a second of the wall's clock, also where a simulated clock stands
/// still.
class PeriodicDiagnostics {
 public:
  /// Fills in the status. `elapsed`: since the last call [s of the wall's clock], 0 at the first.
  using Task = std::function<void(diagnostic_updater::DiagnosticStatusWrapper& status, double elapsed)>;

  /// `pnh`: the node's private handle, whose namespace is the node's full name. `task` is called from the
  /// handle's callback queue; what it uses must outlive this.
  PeriodicDiagnostics(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name,
                      Task task);

  PeriodicDiagnostics(const PeriodicDiagnostics&) = delete;
  PeriodicDiagnostics& operator=(const PeriodicDiagnostics&) = delete;

 private:
  void run(diagnostic_updater::DiagnosticStatusWrapper& status);

  Task task_;
  std::optional<ros::WallTime> last_run_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace sightline_ros
