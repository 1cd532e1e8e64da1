#include "sightline/ros/recordings/recorded_truth.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <rosbag/view.h>
#include <sightline/TrackArray.h>

#include "sightline/core/evaluation/truth.h"
#include "sightline/core/model/angle_range.h"
#include "sightline/core/model/sphere.h"
#include "sightline/report/csv_table.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/evaluation_messages.h"
#include "sightline/ros/recordings/bags.h"

namespace sightline_ros {

namespace core = sightline::core;
namespace report = sightline::report;
using sightline::TrackArray;

namespace {

std::set<std::string> trackTopicsOf(const rosbag::Bag& bag) {
  std::set<std::string> topics;
  rosbag::View view(bag, rosbag::TypeQuery(ros::message_traits::datatype<TrackArray>()));
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) topics.insert(connection->topic);
  return topics;
}

std::string topicList(const std::set<std::string>& topics) {
  std::string list;
  for (const std::string& topic : topics) list += " " + topic;
  return topics.empty() ? " none" : list;
}

/// Numbers for the names of targets: their own where all are numbers, otherwise in the order of the alphabet.
class TargetNumbers {
 public:
  explicit TargetNumbers(const report::CsvTable& table) {
    if (!table.has("target")) return;
    bool all_numbers = true;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const std::string& name = table.text(row, "target");
      all_numbers =
          all_numbers && !name.empty() && name.size() < 10 &&
          std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
      numbers_[name] = 0;
    }
    std::uint32_t next = 1;
    for (auto& [name, number] : numbers_)
      number = all_numbers ? static_cast<std::uint32_t>(std::stoul(name)) : next++;
  }

  std::uint32_t of(const report::CsvTable& table, std::size_t row) const {
    return table.has("target") ? numbers_.at(table.text(row, "target")) : 1;
  }

 private:
  std::map<std::string, std::uint32_t> numbers_;
};

double angle(const report::CsvTable& table, std::size_t row, const std::string& column, double limit) {
  const double value = table.number(row, column, "rad");
  if (std::abs(value) <= limit + core::kAngleRounding) return std::clamp(value, -limit, limit);
  throw table.error(row, column + ": expected radians, at most " + std::to_string(limit) + " in size, got " +
                             table.text(row, column) + " (degrees?)");
}

using TargetOfSensor = std::pair<std::string, std::uint32_t>;

std::map<TargetOfSensor, std::vector<core::TruthDirection>> directionsOf(const report::CsvTable& table) {
  std::map<TargetOfSensor, std::vector<core::TruthDirection>> directions;
  const TargetNumbers numbers(table);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    core::TruthDirection direction;
    direction.time = table.time(row, "time");
    direction.angles.x() = angle(table, row, "azimuth", 2.0 * core::kPi);
    if (table.has("elevation")) direction.angles.y() = angle(table, row, "elevation", 0.5 * core::kPi);
    const std::string sensor = table.has("sensor") ? table.text(row, "sensor") : "";
    directions[{sensor, numbers.of(table, row)}].push_back(direction);
  }
  return directions;
}

}  // namespace

RecordedTruth truthFromBag(const rosbag::Bag& bag, const std::string& topic) {
  RecordedTruth truth;
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& instance : view) {
    const auto message = messageIn<TrackArray>(instance);
    if (!message)
      throw std::runtime_error(topic + ": expected sightline/TrackArray, got " + instance.getDataType());
    truth.frame = message->header.frame_id;
    truth.motions[""][toCore(message->header.stamp)] = motionsOf(*message);
  }
  if (truth.motions.empty()) {
    throw std::runtime_error(
        topic + ": no message of the bag; its TrackArray topics:" + topicList(trackTopicsOf(bag)));
  }
  return truth;
}

RecordedTruth truthFromCsv(const std::string& path, core::Channels channels, double gap) {
  const report::CsvTable table =
      report::CsvTable::fromFile(path, {"time", "azimuth"}, {"target", "sensor", "elevation", "range_m"});
  if (!table.has("elevation") && channels != core::Channels::azimuth_only) {
    throw report::CsvError(path +
                           ": there is no column elevation; compare azimuths alone with --azimuth-only");
  }
  if (table.rows() == 0) throw report::CsvError(path + ": there is a header, but no sample below it");

  RecordedTruth truth;
  for (auto& [target, directions] : directionsOf(table)) {
    std::stable_sort(directions.begin(), directions.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
    for (const core::TruthSample& sample : core::withRates(directions, core::durationOf(gap))) {
      truth.motions[target.first][sample.time][target.second] = sample.motion;
    }
  }
  return truth;
}

RecordedTruth readTruth(const std::string& topic_or_csv, const rosbag::Bag& bag, core::Channels channels,
                        double gap) {
  const std::set<std::string> topics = trackTopicsOf(bag);
  if (topics.count(topic_or_csv) > 0) return truthFromBag(bag, topic_or_csv);
  if (std::filesystem::is_regular_file(topic_or_csv)) return truthFromCsv(topic_or_csv, channels, gap);
  throw std::runtime_error(
      topic_or_csv + ": neither a file nor one of the TrackArray topics of the bag:" + topicList(topics));
}

}  // namespace sightline_ros
