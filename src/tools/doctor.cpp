#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <ros/ros.h>

#include "sightline/report/command_line.h"
#include "sightline/ros/diagnosis/input_doctor.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recording_examination.h"

namespace {

using namespace sightline_ros;

const char* const kUsage =
    "Usage: doctor [--seconds S] [--tracking-frame F] [BAG]\n"
    "Examines the running sensors, trackers and fusions for some time, or those of a recording, and reports "
    "what is wrong\n"
    "with their topics, frames, stamps, rates and covariances, and what to do about it. Of stations that "
    "stand apart it\n"
    "says what the reports of positions tell of their clocks and orientations, and why tracks have no "
    "position.\n"
    "Exit code 0: nothing is wrong; 1: something is.\n"
    "  BAG                  a recording to be examined instead of the running graph\n"
    "  --seconds S          how long to examine the running graph (default 10)\n"
    "  --tracking-frame F   frame in which targets are tracked (default: that of the trackers, or "
    "platform_enu)\n";

std::string millis(const std::optional<double>& seconds) {
  char text[32] = "-";
  if (seconds) std::snprintf(text, sizeof text, "%.1f", 1e3 * *seconds);
  return text;
}

void printSensors(const InputExamination& inputs, const GraphView& graph, const std::string& tracking_frame,
                  double seconds) {
  const auto rows = inputs.sensors();
  std::printf("looked for %g s; sensors: %zu, trackers: %zu, fusions: %zu; tracking frame: %s\n", seconds,
              rows.size(), trackersOf(graph).size(), fusionsOf(graph).size(), tracking_frame.c_str());
  if (!rows.empty()) {
    std::printf("  %-16s %8s %10s %12s %10s %10s  %s\n", "sensor", "scans/s", "sightings", "latency [ms]",
                "95 % [ms]", "sigma", "topic");
  }
  for (const auto& [sensor, topic, record] : rows) {
    std::printf("  %-16s %8.*f %10zu %12s %10s %10.2g  %s\n", sensor.c_str(),
                static_cast<double>(record->scans()) < seconds ? 4 : 1,
                static_cast<double>(record->scans()) / seconds, record->sightings(),
                millis(record->latency(0.5)).c_str(), millis(record->latency(0.95)).c_str(),
                record->statedSigma().value_or(NAN), topic.c_str());
  }
}

/// How many things are wrong.
std::size_t print(const std::vector<Finding>& found) {
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

std::size_t examineGraph(const DoctorParams& params) {
  if (!ros::master::check()) {
    throw std::runtime_error("there is no ROS master at " + ros::master::getURI() +
                             ": start what is to be looked at, set ROS_MASTER_URI, or name a bag");
  }
  ros::NodeHandle nh;
  InputDoctor doctor(nh, params);
  const std::vector<Finding> found = doctor.examine();
  printSensors(doctor.examination(), doctor.graph(), doctor.trackingFrame(), params.seconds);
  return print(found);
}

std::size_t examineBag(const std::string& file, const std::string& tracking_frame) {
  RecordingExaminationParams params;
  params.tracking_frame = tracking_frame;
  const auto bag = openBag(file);
  const RecordingExamination examined = examineRecording(*bag, params);
  printSensors(examined.inputs, examined.graph, examined.tracking_frame, examined.seconds);
  return print(examined.findings);
}

std::size_t examine(const std::vector<std::string>& words) {
  const sightline::report::CommandLine line(words, {"--seconds", "--tracking-frame"}, 0, 1);
  DoctorParams params;
  params.seconds = line.number("--seconds", params.seconds, sightline::report::NumberRange::above_zero);
  params.tracking_frame = line.option("--tracking-frame", "");
  if (line.arguments().empty()) return examineGraph(params);
  if (line.has("--seconds")) {
    throw sightline::report::UsageError(
        "--seconds is for a running graph; a recording is examined as a whole: leave it out");
  }
  return examineBag(line.arguments()[0], params.tracking_frame);
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "sightline_doctor", ros::init_options::AnonymousName);
  std::size_t wrong = 0;
  const int code = sightline::report::runTool(
      argc, argv, kUsage, [&](const std::vector<std::string>& words) { wrong = examine(words); });
  return code == 0 && wrong > 0 ? 1 : code;
}
