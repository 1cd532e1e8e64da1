#include "sightline/ros/recordings/replay.h"

#include <chrono>
#include <cstdio>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/fusion/rules/fusion_rule_table.h"
#include "sightline/report/command_line.h"
#include "sightline/ros/recordings/recording_examination.h"
#include "sightline/ros/recordings/replay_output.h"

namespace {

const char* const kUsageBeforeEstimators =
    "Usage: replay [--config FILE.yaml] [--estimator E] [--rule R] [--positions yes|no] [--smooth] [--lag S] "
    "[--topics T[,T...] | --all] [--live] IN.bag OUT.bag\n"
    "Runs the local trackers and the track fusion over a recording, as fast as the machine allows.\n"
    "  IN.bag       every sightline/SightingArray topic is used, with /tf and /tf_static\n"
    "  OUT.bag      IN.bag with the tracks (instead of those it may hold): one tracker for each sensor on\n"
    "               /sensors/<sensor>/tracks, one over all sightings on /sensor_fusion/tracks, the fusion of "
    "the former\n"
    "               on /fusion/tracks, and associations and reports beside them; of sensors that stand apart "
    "positions on\n"
    "               /positions/tracks instead of fused directions\n"
    "  --config     parameters in the sections local_tracker (of each sensor), sensor_fusion (over all "
    "sightings) and\n"
    "               track_fusion or position_tracker; keys as in config/local_tracker.yaml, "
    "config/track_fusion.yaml and\n"
    "               config/position_tracker.yaml\n"
    "  --positions  yes: each sensor is a station with tf to the frame `world`, and targets have positions; "
    "no: "
    "all look\n"
    "               from one place (default: yes where sensors stand more than a metre apart)\n"
    "  --smooth     also write where each local track was by all its sightings, earlier and later ones: on\n"
    "               /sensors/<sensor>/tracks_smoothed and /sensor_fusion/tracks_smoothed, at the times of "
    "the tracks\n"
    "  --lag S      smooth with sightings up to S seconds later only, as could be done live\n"
    "  --topics     of what is said, write these topics only: names, or beginnings of names with a * at the "
    "end, as in\n"
    "               /fusion/tracks,/sensors/*, with every message of them; messages of IN.bag are copied all "
    "the same\n"
    "  --all        write every message of every topic (default: what the tracker over all sightings says "
    "ten "
    "times a\n"
    "               second at most, the fusion's reports when something is new in them or once a second, no "
    "tracklets)\n"
    "  --live       use scans in their order of arrival, and drop what comes too late for live trackers "
    "(default: nothing\n"
    "               is late)\n"
    "  --estimator  for every tracker, one of:\n";

/// A line of the usage for each row of a table.
template <typename Table>
std::string linesOf(const Table& table) {
  std::string lines;
  for (const auto& entry : table)
    lines += std::string("                 ") + entry.name + ": " + entry.description + "\n";
  return lines;
}

std::string usage() {
  return kUsageBeforeEstimators + linesOf(sightline::core::estimatorTable()) +
         "  --rule       of the fusion, one of:\n" + linesOf(sightline::core::fusionRuleTable());
}

void print(const sightline_ros::ReplaySummary& summary, const std::string& out, double elapsed) {
  std::printf("%s: %zu scans with %zu sightings over %.1f s in %.2f s", out.c_str(), summary.scans,
              summary.sightings, summary.recorded, elapsed);
  std::printf(" (%.0f scans/s, %.0f times real time)\n", static_cast<double>(summary.scans) / elapsed,
              summary.recorded / elapsed);
  std::printf("  %zu track messages written, %zu messages copied\n", summary.track_messages,
              summary.copied_messages);
  if (summary.left_out_messages > 0) {
    std::printf(
        "  %zu messages not written: tracklets, reports without news, tracks over all sightings beyond "
        "%.0f a second (--all writes them)\n",
        summary.left_out_messages, sightline_ros::kSlowRate);
  }
  for (const auto& [sensor, topic] : summary.topics) {
    std::printf("  sensor \"%s\" is found under %s: its name is no topic's\n", sensor.c_str(), topic.c_str());
  }
  for (const auto& [reason, count] : summary.drops) {
    const auto example = summary.examples.find(reason);
    std::printf("  %s: %zu%s\n", reason.c_str(), count,
                example == summary.examples.end() ? "" : (", the first " + example->second).c_str());
  }
  for (const std::string& notice : summary.notices) std::printf("  %s\n", notice.c_str());
  if (summary.drops.empty()) std::printf("  nothing dropped\n");
  std::printf("%s", sightline_ros::linesOf(summary.findings).c_str());
}

/// Of a list with commas.
std::vector<std::string> topicsIn(const std::string& list) {
  std::vector<std::string> topics;
  std::istringstream rest(list);
  for (std::string topic; std::getline(rest, topic, ',');) {
    if (topic.empty() || topic.front() != '/')
      throw sightline::report::UsageError("--topics needs names of topics like /fusion/tracks, got \"" +
                                          topic + "\"");
    topics.push_back(topic);
  }
  return topics;
}

void run(const std::vector<std::string>& words) {
  using namespace sightline_ros;
  const sightline::report::CommandLine line(
      words, {"--config", "--estimator", "--rule", "--positions", "--lag", "--topics"}, 2, 2,
      {"--live", "--smooth", "--all"});
  ReplaySettings settings{line.option("--config", ""), line.option("--estimator", ""),
                          line.option("--rule", ""), line.has("--live"), std::nullopt};
  if (line.has("--positions")) settings.positions = line.yesOrNo("--positions", false);
  settings.smooth = line.has("--smooth") || line.has("--lag");
  if (line.has("--lag"))
    settings.lag = line.number("--lag", 0.0, sightline::report::NumberRange::at_least_zero);
  if (line.has("--topics")) settings.topics = topicsIn(line.option("--topics", ""));
  settings.all = line.has("--all");
  if (settings.all && line.has("--topics"))
    throw sightline::report::UsageError(
        "--all writes every topic, --topics some of them: give one of the two");
  const auto start = std::chrono::steady_clock::now();
  const ReplaySummary summary = replay(line.arguments()[0], line.arguments()[1], settings);
  print(summary, line.arguments()[1],
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, usage(), run);
}
