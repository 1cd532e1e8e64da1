#include <iostream>

#include "sightline/report/command_line.h"
#include "sightline/ros/recordings/csv_recordings.h"

namespace {

const char* const kUsage =
    "Usage: csv_to_bag [--frame FRAME | --stations STATIONS.csv] [--offset SECONDS] IN.csv OUT.bag\n"
    "Turns a recording of sightings into a bag that replay and rosbag play understand.\n"
    "  IN.csv    header line time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation[,scan]; seconds and "
    "radians.\n"
    "            Rows of one sensor with the same `scan` are one exposure; without that column each row is.\n"
    "  OUT.bag   sightline/SightingArray on /sensors/<sensor>/sightings\n"
    "  --frame   frame of the angles (default platform_enu, the tracking frame: x east, y north, z up)\n"
    "  --stations  positions of the sensors, with the columns sensor,east_m,north_m,up_m (axes parallel to "
    "world) or\n"
    "            sensor,latitude_deg,longitude_deg,height_m (WGS-84): each sensor's scans are in a frame of "
    "its own,\n"
    "            with its place in /tf_static\n"
    "  --offset  is added to all times: a bag cannot hold times up to 0 (default 0)\n";

void convert(const std::vector<std::string>& words) {
  using namespace sightline_ros;
  const sightline::report::CommandLine line(words, {"--frame", "--offset", "--stations"}, 2, 2);
  if (line.has("--frame") && line.has("--stations"))
    throw sightline::report::UsageError(
        "--frame and --stations: stations have frames of their own: leave --frame out");
  std::cout << convertCsvToBag(line.arguments()[0], line.arguments()[1],
                               line.option("--frame", "platform_enu"), line.number("--offset", 0.0),
                               line.option("--stations", ""))
            << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, kUsage, convert);
}
