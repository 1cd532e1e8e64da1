#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <sightline/PositionReport.h>
#include <sightline/StationError.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/diagnosis/graph_view.h"
#include "sightline/ros/diagnosis/sensor_record.h"

namespace sightline_ros {

/// What position trackers reported over some time: what is known of the clock and the orientation of each
/// station, which station harms, and why local tracks have no position. No node: reports are handed in. The
/// memory is bounded.
class PositionExamination {
 public:
  /// A report of that topic, in the order in which they were sent.
  void take(const sightline::PositionReport& report, const std::string& topic);

  /// By topic: what harms the positions, what is known of each station by the last report (clock [s] and
  /// rotation [mrad] with standard deviations, or that the targets do not tell them), and by station which
  /// local tracks were without a position for a second or more, and why. Only what is harmful is no note.
  std::vector<Finding> findings() const;

  /// Topics of reports that are published, and brought nothing within `seconds`.
  std::vector<Finding> silentTopics(const GraphView& graph, double seconds) const;

 private:
  /// For how long a local track was without a position, by one reason.
  struct Lack {
    double seconds = 0.0;
    std::string reason;  // in words, of the last report
  };
  struct LocalTrack {
    sightline::core::Time last_without{};
    std::size_t number_without = 0;     // of the last report that had no position of it
    std::map<std::string, Lack> lacks;  // by kind
  };
  struct Reported {
    std::size_t reports = 0;
    std::size_t incomplete = 0;
    bool has_positions = false;  // in any report
    std::string frame;
    std::map<std::pair<std::string, std::string>, sightline::StationError> stations;  // by tracker, sensor
    std::map<std::string, LocalTrack> tracks;  // those that were without a position
  };

  static void findStations(const std::string& topic, const Reported& reported, std::vector<Finding>& found);
  static void findUnlocated(const std::string& topic, const Reported& reported, std::vector<Finding>& found);

  std::map<std::string, Reported> reported_;  // by topic
};

/// Topics of reports of positions.
std::vector<GraphView::Topic> positionReportTopics(const GraphView& graph);

}  // namespace sightline_ros
