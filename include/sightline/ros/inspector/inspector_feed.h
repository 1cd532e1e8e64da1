#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include <ros/callback_queue.h>
#include <ros/master.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/spinner.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>

#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/inspector/inspector_model.h"
#include "sightline/ros/inspector/knob_board.h"
#include "sightline/ros/inspector/save_request.h"

namespace sightline_ros {

/// Fills an InspectorModel with whatever topics of tracks, decisions and reports there are, as they come and
/// go, in a thread of its own: a window that is slow to draw holds nothing up, and callbacks touch no widget.
class InspectorFeed {
 public:
  static constexpr std::size_t kMostSubscriptions = 512;

  /// `save_service`: of the flight recorder.
  explicit InspectorFeed(const std::string& save_service = "/flight_recorder/save");
  ~InspectorFeed();

  InspectorFeed(const InspectorFeed&) = delete;
  InspectorFeed& operator=(const InspectorFeed&) = delete;

  /// Uses the model, from any thread, while nothing is taken in; what refers into it must not leave.
  template <typename Use>
  auto with(Use use) {
    const std::lock_guard<std::mutex> lock(mutex_);
    model_.tick(toCoreNow());
    return use(model_);
  }

  /// Tells the displays which track is looked at, and whether it alone.
  void announce(const std::optional<TrackKey>& key, bool alone);

  SaveRequest& recorder() { return recorder_; }
  KnobBoard& knobs() { return knobs_; }

 private:
  static sightline::core::Time toCoreNow();

  void findTopics();
  void listen(const ros::master::TopicInfo& topic);
  template <typename Message, typename Take>
  void subscribe(const std::string& topic, Take take);

  CallbackGuard guard_{"TrackInspector"};
  std::mutex mutex_;  // of the model
  InspectorModel model_;
  SaveRequest recorder_;
  KnobBoard knobs_;
  ros::CallbackQueue queue_;
  ros::NodeHandle nh_;
  std::map<std::string, ros::Subscriber> subscribers_;  // by topic
  ros::Publisher selection_;
  ros::WallTimer discovery_;
  ros::AsyncSpinner spinner_{1, &queue_};
};

}  // namespace sightline_ros
