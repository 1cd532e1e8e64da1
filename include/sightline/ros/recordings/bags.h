#pragma once

#include <boost/make_shared.hpp>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/message_instance.h>

#include "sightline/report/output_file.h"

namespace sightline_ros {

/// A bag open for reading. Throws std::runtime_error with the file's name and what is wrong with it.
std::unique_ptr<rosbag::Bag> openBag(const std::string& file);

/// Writes a bag that is complete or not there (OutputFile): in its place once it is finished.
class BagWriter {
 public:
  /// `inputs`: files that are read meanwhile. Throws OutputError when the file cannot be written or is one of
  /// them.
  explicit BagWriter(const std::string& file, const std::vector<std::string>& inputs = {});
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  rosbag::Bag* operator->() { return bag_.get(); }
  rosbag::Bag& operator*() { return *bag_; }

  /// Closes the bag and puts it in its place. Throws OutputError.
  void finish();

 private:
  void close();

  sightline::report::OutputFile file_;
  std::unique_ptr<rosbag::Bag> bag_;
};

/// Writes a bag with what `fill` writes into it. Throws OutputError when it cannot be written, as on a full
/// disk, and whatever `fill` throws; then there is no bag.
void writeBag(const std::string& file, const std::vector<std::string>& inputs,
              const std::function<void(rosbag::Bag& bag)>& fill);

/// What is wrong with a message that does not hold what its type says: topic, time and remedy.
std::runtime_error brokenMessage(const rosbag::MessageInstance& instance);

/// A message of a recording; null when it is of another type, or of another definition of it. Throws
/// `brokenMessage` of one that was cut.
template <typename Message>
boost::shared_ptr<Message> messageIn(const rosbag::MessageInstance& instance) {
  try {
    return instance.instantiate<Message>();
  } catch (const ros::serialization::StreamOverrunException&) {
    throw brokenMessage(instance);
  }
}

/// The connection header of a latched topic: players publish its last message to whoever subscribes later.
template <typename Message>
boost::shared_ptr<ros::M_string> latchedHeader() {
  auto header = boost::make_shared<ros::M_string>();
  (*header)["type"] = ros::message_traits::datatype<Message>();
  (*header)["md5sum"] = ros::message_traits::md5sum<Message>();
  (*header)["message_definition"] = ros::message_traits::definition<Message>();
  (*header)["latching"] = "1";
  return header;
}

/// Whether a name can be a part of a topic: letters, digits, underscores, and at least one.
bool isTopicPart(const std::string& name);

/// For each sensor its part of a topic: its name where that can be one, otherwise a similar one that no other
/// sensor has.
std::map<std::string, std::string> topicPartsOf(const std::set<std::string>& sensors);

/// /sensors/<sensor>/<what>.
std::string sensorTopic(const std::string& sensor, const std::string& what);

}  // namespace sightline_ros
