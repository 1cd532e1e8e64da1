#include "sightline/ros/inspector/save_request.h"

#include <std_srvs/Trigger.h>

#include <ros/node_handle.h>

namespace sightline_ros {

SaveRequest::~SaveRequest() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_given_up_ = true;
    client_.shutdown();  // drops the connection, so that a call that waits for its answer returns
  }
  if (thread_.joinable()) thread_.join();
}

void SaveRequest::start() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_under_way_) return;
    is_under_way_ = true;
    words_ = "saving ...";
  }
  if (thread_.joinable()) thread_.join();
  thread_ = std::thread([this] { run(); });
}

void SaveRequest::run() {
  ros::NodeHandle nh;
  // Persistent: only such a connection can be dropped from outside while a call waits.
  ros::ServiceClient client = nh.serviceClient<std_srvs::Trigger>(service_, true);
  if (!client.isValid())
    return finish("not saved: no flight recorder at " + service_ +
                  " (roslaunch sightline flight_recorder.launch)");
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_given_up_) return;
    client_ = client;
  }
  std_srvs::Trigger call;
  if (!client.call(call)) return finish("not saved: " + service_ + " did not answer");
  finish(call.response.success ? "saved " + call.response.message : "not saved: " + call.response.message);
}

void SaveRequest::finish(const std::string& words) {
  const std::lock_guard<std::mutex> lock(mutex_);
  client_ = ros::ServiceClient();
  words_ = words;
  is_under_way_ = false;
}

std::string SaveRequest::words() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return words_;
}

bool SaveRequest::isUnderWay() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return is_under_way_;
}

}  // namespace sightline_ros
