#include <iostream>

#include "sightline/report/command_line.h"
#include "sightline/ros/recordings/csv_recordings.h"

namespace {

const char* const kUsage =
    "Usage: bag_to_csv [--sightings] [--topic TOPIC]... IN.bag OUT.csv\n"
    "Writes the tracks of a bag as a table, a line for each track and message, in order of time.\n"
    "  IN.bag   with sightline/TrackArray messages, for instance the output of replay\n"
    "  OUT.csv  time,tracker,track,status, then angles, rates and their sigmas; seconds and radians\n"
    "  --sightings  writes the sightings instead, as csv_to_bag reads them; a row without angles saw "
    "nothing\n"
    "  --topic  only this topic; may be given several times (default: all of them)\n";

void convert(const std::vector<std::string>& words) {
  using namespace sightline_ros;
  const sightline::report::CommandLine line(words, {"--topic"}, 2, 2, {"--sightings"});
  const auto convertTo = line.has("--sightings") ? convertBagToSightingCsv : convertBagToCsv;
  std::cout << convertTo(line.arguments()[0], line.arguments()[1], line.all("--topic")) << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, kUsage, convert);
}
