#pragma once

#include <memory>
#include <string>

#include <rosbag/bag.h>

namespace sightline_ros {

/// A bag open for reading. Throws std::runtime_error with the file's name and what is wrong with it.
std::unique_ptr<rosbag::Bag> openBag(const std::string& file);

/// A bag under way: written beside its place, and put there by `finish`; removed when it was not finished. So
/// what stands under the name is always whole.
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

/// /sensors/<sensor>/<what>.
std::string sensorTopic(const std::string& sensor, const std::string& what);

}  // namespace sightline_ros
