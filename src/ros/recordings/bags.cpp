#include "sightline/ros/recordings/bags.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <rosbag/exceptions.h>

namespace sightline_ros {

std::unique_ptr<rosbag::Bag> openBag(const std::string& file) {
  if (!std::filesystem::exists(file)) throw std::runtime_error(file + ": there is no such file");
  try {
    return std::make_unique<rosbag::Bag>(file, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw std::runtime_error(file +
                             ": the recording was not closed properly; repair it with `rosbag reindex`");
  } catch (const rosbag::BagException& problem) {
    throw std::runtime_error(file + ": is no readable bag: " + problem.what());
  }
}

BagWriter::BagWriter(const std::string& file) : file_(file), unfinished_(file + ".unfinished") {
  try {
    bag_.open(unfinished_, rosbag::bagmode::Write);
  } catch (const rosbag::BagException& problem) {
    throw std::runtime_error(file + ": cannot be written: " + problem.what());
  }
}

BagWriter::~BagWriter() {
  if (unfinished_.empty()) return;
  bag_.close();
  std::remove(unfinished_.c_str());
}

void BagWriter::finish() {
  bag_.close();
  if (std::rename(unfinished_.c_str(), file_.c_str()) != 0) {
    throw std::runtime_error(file_ + ": cannot be written: " + std::strerror(errno));
  }
  unfinished_.clear();
}

bool isTopicPart(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '_';
  });
}

std::map<std::string, std::string> topicPartsOf(const std::set<std::string>& sensors) {
  std::map<std::string, std::string> parts;
  std::set<std::string> taken = sensors;
  for (const std::string& sensor : sensors) {
    std::string part = sensor;
    for (char& letter : part) {
      if (!isTopicPart(std::string(1, letter))) letter = '_';
    }
    while (part != sensor && !taken.insert(part).second) part += '_';
    parts[sensor] = part;
  }
  return parts;
}

std::string sensorTopic(const std::string& sensor, const std::string& what) {
  return "/sensors/" + sensor + "/" + what;
}

}  // namespace sightline_ros
