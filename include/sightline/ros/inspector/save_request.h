#pragma once

#include <mutex>
#include <string>
#include <thread>

#include <ros/service_client.h>

namespace sightline_ros {

/// Asks a flight recorder for its last minute (std_srvs/Trigger), without holding anybody up meanwhile.
class SaveRequest {
 public:
  /// `service`: full name, for instance /flight_recorder/save.
  explicit SaveRequest(std::string service) : service_(std::move(service)) {}

  /// Gives up what is under way.
  ~SaveRequest();

  SaveRequest(const SaveRequest&) = delete;
  SaveRequest& operator=(const SaveRequest&) = delete;

  /// Begins a request; nothing happens while one is under way.
  void start();

  /// What became of the last one: empty before the first; where the bag is; why there is none.
  std::string words() const;
  bool isUnderWay() const;

 private:
  void run();
  void finish(const std::string& words);

  const std::string service_;
  mutable std::mutex mutex_;  // of everything below but the thread
  ros::ServiceClient client_;
  std::string words_;
  bool is_under_way_ = false;
  bool is_given_up_ = false;
  std::thread thread_;
};

}  // namespace sightline_ros
