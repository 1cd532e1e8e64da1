#include "sightline/ros/recordings/bags.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <console_bridge/console.h>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <rosbag/exceptions.h>

namespace sightline_ros {

namespace report = sightline::report;
using report::outputError;

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

namespace {

/// A bag that is open and cannot be written to its end is left as it is: its destructor would try to close
/// it, and throw. At the end of the program class_loader (of Debian 13) would complain of what lives on in
/// it.
void giveUp(std::unique_ptr<rosbag::Bag> bag) {
  if (!bag->isOpen()) return;
  static auto* const given_up = new std::vector<rosbag::Bag*>();
  given_up->push_back(bag.release());
  console_bridge::noOutputHandler();
}

}  // namespace

BagWriter::BagWriter(const std::string& file, const std::vector<std::string>& inputs)
    : file_(file, inputs), bag_(std::make_unique<rosbag::Bag>()) {
  errno = 0;
  try {
    bag_->open(file_.unfinished(), rosbag::bagmode::Write);
  } catch (const rosbag::BagException& problem) {
    const int reason = errno;
    giveUp(std::move(bag_));
    errno = reason;
    if (errno != 0) throw outputError(file);
    throw report::OutputError(file + ": cannot be written: " + problem.what());
  }
}

BagWriter::~BagWriter() {
  try {
    if (bag_) close();
  } catch (const std::exception&) {  // nobody needs it any more
  }
}

void BagWriter::close() {
  std::unique_ptr<rosbag::Bag> bag = std::move(bag_);
  try {
    bag->close();
  } catch (...) {
    const int reason = errno;
    giveUp(std::move(bag));
    errno = reason;
    throw;
  }
}

void BagWriter::finish() {
  errno = 0;
  try {
    close();
  } catch (const rosbag::BagException& problem) {
    if (errno != 0) throw outputError(file_.path());
    throw report::OutputError(file_.path() + ": cannot be written: " + problem.what());
  }
  file_.finish();
}

void writeBag(const std::string& file, const std::vector<std::string>& inputs,
              const std::function<void(rosbag::Bag& bag)>& fill) {
  BagWriter bag(file, inputs);
  errno = 0;
  try {
    fill(*bag);
  } catch (const rosbag::BagIOException& problem) {
    const bool is_of_output = errno == ENOSPC || errno == EFBIG || errno == EDQUOT;
    if (is_of_output) throw outputError(file);
    if (std::string(problem.what()).find("writing") != std::string::npos)
      throw report::OutputError(file + ": cannot be written: " + problem.what());
    throw;
  }
  bag.finish();
}

std::runtime_error brokenMessage(const rosbag::MessageInstance& instance) {
  std::ostringstream why;
  why << std::fixed << std::setprecision(3) << "the message on " << instance.getTopic()
      << " that was recorded at " << instance.getTime().toSec() << " s is shorter than its type "
      << instance.getDataType() << " says: leave it out (rosbag filter IN.bag OUT.bag \"t.to_sec() != ...\")";
  return std::runtime_error(why.str());
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
