// Time from a scan to the tracks it makes, as another process sees it: from the arrival of the SightingArray
// to the arrival of the TrackArray of the same stamp, for every sensor with a tracker of its own
// (/sensors/<sensor>/sightings and tracks). Run it beside six_sensors.launch (bench/platform_load does).
//
//   latency [SECONDS]     (default 20)

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>

#include "quantiles.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "latency", ros::init_options::AnonymousName);
  const double length = argc > 1 ? std::atof(argv[1]) : 20.0;
  if (!(length > 0.0)) {
    std::fprintf(stderr, "usage: latency [SECONDS]   (> 0)\n");
    return 2;
  }
  ros::NodeHandle nh;
  std::map<std::pair<std::string, ros::Time>, ros::WallTime> arrivals;
  std::vector<double> latencies;  // [s]
  std::vector<ros::Subscriber> subscribers;
  for (const char* sensor :
       {"acquisition_1", "acquisition_2", "acquisition_3", "tracking_1", "tracking_2", "tracking_3"}) {
    const std::string name = sensor, space = "/sensors/" + name;
    subscribers.push_back(nh.subscribe<sightline::SightingArray>(
        space + "/sightings", 1000,
        [&, name](const sightline::SightingArray::ConstPtr& scan) {
          arrivals[{name, scan->header.stamp}] = ros::WallTime::now();
        },
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
    subscribers.push_back(nh.subscribe<sightline::TrackArray>(
        space + "/tracks", 1000,
        [&, name](const sightline::TrackArray::ConstPtr& tracks) {
          const auto scan = arrivals.find({name, tracks->header.stamp});
          // Tracks that overtake their scan on the way to this process took no time that it could see.
          latencies.push_back(scan == arrivals.end() ? 0.0 : (ros::WallTime::now() - scan->second).toSec());
        },
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  }
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(length);
  while (ros::ok() && ros::WallTime::now() < end)
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
  if (latencies.empty()) {
    std::fprintf(stderr, "latency: no tracks came on /sensors/*/tracks; is six_sensors.launch running?\n");
    return 1;
  }
  using sightline::bench::median;
  using sightline::bench::quantile;
  std::printf("%zu scans: median %.2f ms, 99 %% %.2f ms, longest %.2f ms\n", latencies.size(),
              1e3 * median(latencies), 1e3 * quantile(latencies, 0.99), 1e3 * quantile(latencies, 1.0));
  return 0;
}
