#include <iostream>

#include "sightline/formats/import_command.h"
#include "sightline/report/command_line.h"
#include "sightline/ros/recordings/imported_recording.h"

namespace {

std::string usage() {
  return "Usage: import_sightings [options] FILE... OUT.bag\n"
         "       import_sightings --truth [options] FILE... OUT.csv\n"
         "Reads files of other programs, by their content, into a bag that replay and rosbag play "
         "understand, and says what "
         "it understood.\n"
         "  OUT.bag                 sightline/SightingArray on /sensors/<sensor>/sightings; positions in "
         "/tf_static\n"
         "  --truth                 writes the directions as a truth for evaluate --truth\n"
         "  --frame FRAME           frame of all angles, without positions (default: each sensor's own where "
         "its position "
         "is\n"
         "                          known, else platform_enu: x east, y north, z up)\n" +
         sightline::formats::importOptionUsage();
}

void import(const std::vector<std::string>& words) {
  using namespace sightline_ros;
  std::vector<std::string> options = sightline::formats::importOptionNames();
  options.push_back("--frame");
  const sightline::report::CommandLine line(words, options, 2, 1000, {"--truth"});
  std::vector<std::string> files = line.arguments();
  const std::string out = files.back();
  files.pop_back();
  const auto told = sightline::formats::importOptionsOf(line);
  if (line.has("--truth") && line.has("--frame"))
    throw sightline::report::UsageError("--frame is of a bag; a truth has none: leave one of the two out");
  std::cout << (line.has("--truth") ? importTruth(files, out, told)
                                    : importSightings(files, out, told, line.option("--frame", "")));
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, usage(), import);
}
