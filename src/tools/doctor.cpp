#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <ros/ros.h>

#include "sightline/report/command_line.h"
#include "sightline/ros/diagnosis/input_doctor.h"

namespace {

using namespace sightline_ros;

const char* const kUsage =
    "Usage: doctor [--seconds S] [--tracking-frame F]\n"
    "Examines the running sensors, trackers and fusions for some time, and reports what is wrong with their\n"
    "topics, frames, stamps, rates and covariances, and what to do about it.\n"
    "Exit code 0: nothing is wrong; 1: something is.\n"
    "  --seconds S          how long to examine (default 10)\n"
    "  --tracking-frame F   frame in which targets are tracked (default: that of the running trackers, or "
    "platform_enu)\n";

std::string millis(const std::optional<double>& seconds) {
  char text[32] = "-";
  if (seconds) std::snprintf(text, sizeof text, "%.1f", 1e3 * *seconds);
  return text;
}

void printSensors(const InputDoctor& doctor, double seconds) {
  const auto rows = doctor.examination().sensors();
  std::printf("looked for %g s; sensors: %zu, trackers: %zu, fusions: %zu; tracking frame: %s\n", seconds,
              rows.size(), trackersOf(doctor.graph()).size(), fusionsOf(doctor.graph()).size(),
              doctor.trackingFrame().c_str());
  if (!rows.empty()) {
    std::printf("  %-16s %8s %10s %12s %10s %10s  %s\n", "sensor", "scans/s", "sightings", "latency [ms]",
                "95 % [ms]", "sigma", "topic");
  }
  for (const auto& [sensor, topic, record] : rows) {
    std::printf("  %-16s %8.1f %10zu %12s %10s %10.2g  %s\n", sensor.c_str(),
                static_cast<double>(record->scans()) / seconds, record->sightings(),
                millis(record->latency(0.5)).c_str(), millis(record->latency(0.95)).c_str(),
                record->statedSigma().value_or(NAN), topic.c_str());
  }
}

/// How many things are wrong.
std::size_t examine(const std::vector<std::string>& words) {
  const sightline::report::CommandLine line(words, {"--seconds", "--tracking-frame"}, 0, 0);
  DoctorParams params;
  params.seconds = line.number("--seconds", params.seconds, sightline::report::NumberRange::above_zero);
  params.tracking_frame = line.option("--tracking-frame", "");
  if (!ros::master::check()) {
    throw std::runtime_error("there is no ROS master at " + ros::master::getURI() +
                             ": start what is to be looked at, or set ROS_MASTER_URI");
  }
  ros::NodeHandle nh;
  InputDoctor doctor(nh, params);
  const std::vector<Finding> found = doctor.examine();
  printSensors(doctor, params.seconds);
  std::size_t wrong = 0;
  for (const Finding& finding : found) {
    std::printf("%s  %s: %s\n", finding.is_note ? "note " : "WRONG", finding.subject.c_str(),
                finding.words.c_str());
    wrong += finding.is_note ? 0 : 1;
  }
  if (wrong == 0)
    std::printf("nothing wrong found\n");
  else
    std::printf("%zu %s wrong\n", wrong, wrong == 1 ? "thing is" : "things are");
  return wrong;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "sightline_doctor", ros::init_options::AnonymousName);
  std::size_t wrong = 0;
  const int code = sightline::report::runTool(
      argc, argv, kUsage, [&](const std::vector<std::string>& words) { wrong = examine(words); });
  return code == 0 && wrong > 0 ? 1 : code;
}
