#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include <rosbag/bag.h>

namespace sightline_ros {

/// A bag open for reading. Throws std::runtime_error with the file's name and what is wrong with it.
std::unique_ptr<rosbag::Bag> openBag(const std::string& file);

/// Writes a bag under a temporary name beside `file`. `finish` renames it; without `finish` it is removed. So
/// the file is always complete.
class BagWriter {
 public:
  /// Throws std::runtime_error when the file cannot be written.
  explicit BagWriter(const std::string& file);
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  rosbag::Bag* operator->() { return &bag_; }
  rosbag::Bag& operator*() { return bag_; }
  void finish();

 private:
  std::string file_;
  std::string unfinished_;
  rosbag::Bag bag_;
};

/// Whether a name can be a part of a topic: letters, digits, underscores, and at least one.
bool isTopicPart(const std::string& name);

/// For each sensor its part of a topic: its name where that can be one, otherwise a similar one that no other
/// sensor has.
std::map<std::string, std::string> topicPartsOf(const std::set<std::string>& sensors);

/// /sensors/<sensor>/<what>.
std::string sensorTopic(const std::string& sensor, const std::string& what);

}  // namespace sightline_ros
