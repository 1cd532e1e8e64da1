#include "sightline/ros/inspector/sighting_log.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include <ros/names.h>

#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

using sightline::Association;

namespace {

const char* const kFurther = "(further ones)";

std::string distance(float squared) {
  std::ostringstream text;
  text.precision(3);
  text << squared;
  return text.str();
}

SightingRecord recordOf(const Association& row) {
  SightingRecord record;
  record.track = row.track;
  record.sighting = row.sighting;
  record.decision = row.decision;
  record.innovation = {static_cast<float>(row.innovation[0]), static_cast<float>(row.innovation[1])};
  record.covariance = {static_cast<float>(row.covariance[0]), static_cast<float>(row.covariance[1]),
                       static_cast<float>(row.covariance[3])};
  record.distance_squared = static_cast<float>(row.distance_squared);
  record.threshold = static_cast<float>(row.threshold);
  return record;
}

}  // namespace

std::uint16_t NameTable::indexOf(const std::string& name) {
  const auto known = std::find(names_.begin(), names_.end(), name);
  if (known != names_.end()) return static_cast<std::uint16_t>(known - names_.begin());
  if (names_.size() < most_) names_.push_back(names_.size() + 1 < most_ ? name : kFurther);
  return static_cast<std::uint16_t>(names_.size() - 1);
}

std::string decisionWord(const SightingRecord& record) {
  switch (record.decision) {
    case Association::ACCEPTED:
      return "taken";
    case Association::STARTED_TRACK:
      return "started it";
    default:
      return "refused";
  }
}

std::string reasonOf(const SightingRecord& record) {
  const std::string squared = "distance squared " + distance(record.distance_squared);
  switch (record.decision) {
    case Association::ACCEPTED:
      return squared + " of at most " + distance(record.threshold);
    case Association::STARTED_TRACK:
      return "in no gate: the track was initiated from it";
    case Association::OUTSIDE_GATE:
      return squared + " is beyond the gate's " + distance(record.threshold);
    case Association::CLAIMED_BY_OTHER:
      if (std::isfinite(record.taken_instead))
        return "in the gate (" + distance(record.distance_squared) +
               "), but the track took another sighting of the scan (" + distance(record.taken_instead) + ")";
      return "in the gate (" + distance(record.distance_squared) + "), but given to a more likely track";
    default:
      return "rejected input";
  }
}

std::string spaceOf(const std::string& topic) {
  return ros::names::parentNamespace(topic);
}

void SightingLog::take(const std::string& topic, const sightline::AssociationArray& decisions,
                       sightline::core::Time arrival) {
  std::map<std::uint32_t, float> taken;  // by track
  for (const Association& row : decisions.associations) {
    if (row.decision == Association::ACCEPTED) taken[row.track] = static_cast<float>(row.distance_squared);
  }
  const std::uint16_t space = spaces_.indexOf(spaceOf(topic)), sensor = sensors_.indexOf(decisions.sensor);
  for (const Association& row : decisions.associations) {
    if (row.track == 0) continue;
    SightingRecord record = recordOf(row);
    record.arrival = arrival;
    record.stamp = toCore(decisions.header.stamp);
    record.space = space;
    record.sensor = sensor;
    const auto instead = taken.find(row.track);
    if (row.decision == Association::CLAIMED_BY_OTHER && instead != taken.end())
      record.taken_instead = instead->second;
    all_.add(record);
    if (keys_.count({space, row.track}) > 0) followed_.add(record);
  }
}

void SightingLog::follow(const std::set<TrackInSpace>& tracks) {
  std::set<Key> keys;
  for (const auto& [space, id] : tracks) keys.insert({spaces_.indexOf(space), id});
  if (keys == keys_) return;
  std::vector<SightingRecord> records;
  for (const SightingRecord& record : followed_) {
    if (keys.count({record.space, record.track}) > 0) records.push_back(record);
  }
  for (const SightingRecord& record : all_) {
    const Key key{record.space, record.track};
    if (keys.count(key) > 0 && keys_.count(key) == 0) records.push_back(record);
  }
  std::stable_sort(records.begin(), records.end(),
                   [](const SightingRecord& a, const SightingRecord& b) { return a.arrival < b.arrival; });
  followed_.clear();
  for (const SightingRecord& record : records) followed_.add(record);
  keys_ = std::move(keys);
}

void SightingLog::clear() {
  all_.clear();
  followed_.clear();
}

}  // namespace sightline_ros
