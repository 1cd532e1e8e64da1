#include "sightline/ros/diagnosis/input_examination.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>

#include <tf2/exceptions.h>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/sensors/scatter.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::listOf;
using sightline::report::valueOf;

namespace {

constexpr std::size_t kMostShots = 400;      // of a sensor
constexpr std::size_t kMostSightings = 100;  // of a shot
constexpr std::size_t kMostSources = 1000;
constexpr double kLeastReach = 0.2;   // angle within which sensors see the same [rad] ...
constexpr double kReachSigmas = 4.0;  // ... and so many stated sigmas
constexpr double kAgreement = 0.02;   // angle within which another reading explains it [rad]
constexpr double kTooSmall = 2.0;     // scatter over the stated sigma
constexpr double kTooLarge = 1.0 / 3.0;
constexpr double kFewTransforms = 0.9;  // share of the scans that must have theirs

/// The namespace of a topic, "/sensors/eye" of "/sensors/eye/tracks": it tells trackers apart.
std::string namespaceOf(const std::string& topic) {
  return topic.substr(0, topic.rfind('/'));
}

/// How the sigma of the scatter stands to the stated one, with what may have been meant.
std::string scatterText(double stated, double ratio) {
  const double actual = ratio * stated;
  std::string words = "it states a sigma of " + valueOf(stated, "rad") + ", and its sightings scatter by " +
                      valueOf(actual, "rad") + ", " + valueOf(ratio, "times") + " as much";
  const bool is_squared = stated < 0.1 && std::abs(std::log(stated / (actual * actual))) < std::log(2.0);
  return words + (is_squared ? ": a variance given for the sigma?" : "");
}

Eigen::Vector2d asSent(const Eigen::Vector2d& angles) {
  return angles;
}

/// Another way to read a sensor's angles, and what it would mean.
struct Mistake {
  Eigen::Vector2d (*reading)(const Eigen::Vector2d&);
  const char* words;
};

const std::array<Mistake, 4> kMistakes{{
    {[](const Eigen::Vector2d& a) -> Eigen::Vector2d { return a * core::kPi / 180.0; },
     "read as degrees they would agree with the others': are these degrees?"},
    {[](const Eigen::Vector2d& a) -> Eigen::Vector2d {
       return {-a.x(), a.y()};
     },
     "with azimuths of the other sign they would agree with the others': they count counter-clockwise"},
    {[](const Eigen::Vector2d& a) -> Eigen::Vector2d {
       return {a.x(), -a.y()};
     },
     "with elevations of the other sign they would agree with the others': up is positive"},
    {[](const Eigen::Vector2d& a) -> Eigen::Vector2d {
       return {a.y(), a.x()};
     },
     "with azimuth and elevation exchanged they would agree with the others'"},
}};

}  // namespace

void InputExamination::take(const sightline::SightingArray& scan, const std::string& topic,
                            const std::string& publisher, core::Time arrival) {
  const Key key(scan.sensor, topic);
  if (sources_.size() >= kMostSources && sources_.count(key) == 0) return;
  Source& source = sources_[key];
  source.record.take(scan, arrival);
  source.publishers.insert(publisher);
  keepShot(scan, source);
}

/// Keeps some scans, evenly over the time.
void InputExamination::keepShot(const sightline::SightingArray& scan, Source& source) {
  if (source.record.scans() % source.every != 0) return;
  Shot shot;
  shot.header = scan.header;
  for (const sightline::Sighting& sighting : scan.sightings) {
    if (shot.sightings.size() == kMostSightings) break;
    Seen seen;
    seen.angles = {sighting.azimuth, sighting.elevation};
    seen.covariance =
        Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(sighting.covariance.data());
    seen.is_usable = !core::rejectionOf(seen.angles, seen.covariance);
    shot.sightings.push_back(seen);
  }
  source.shots.push_back(std::move(shot));
  if (source.shots.size() < kMostShots) return;
  for (std::size_t k = 0; 2 * k < source.shots.size(); ++k) std::swap(source.shots[k], source.shots[2 * k]);
  source.shots.resize((source.shots.size() + 1) / 2);
  source.every *= 2;
}

void InputExamination::take(const sightline::TrackArray& tracks, const std::string& topic) {
  const auto tracker = trackers_.find(namespaceOf(topic));
  if (tracker != trackers_.end()) tracker->second.starts.take(tracks);
}

void InputExamination::turn(const tf2::BufferCore& transforms, const std::string& tracking_frame) {
  for (auto& [key, source] : sources_) {
    for (auto shot = source.shots.rbegin(); shot != source.shots.rend() && !shot->is_turned; ++shot)
      turn(*shot, transforms, tracking_frame);
  }
}

void InputExamination::turn(Shot& shot, const tf2::BufferCore& transforms,
                            const std::string& tracking_frame) {
  shot.is_turned = true;
  if (shot.header.frame_id == tracking_frame) {
    shot.R_tracking_sensor = Eigen::Matrix3d::Identity();
    return;
  }
  try {
    const auto q = transforms.lookupTransform(tracking_frame, shot.header.frame_id, shot.header.stamp)
                       .transform.rotation;
    shot.R_tracking_sensor = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  } catch (const tf2::TransformException& problem) {
    shot.why = problem.what();
  }
}

void InputExamination::take(const sightline::AssociationArray& associations, const std::string& topic) {
  const std::string name = namespaceOf(topic);
  if (trackers_.size() >= kMostSources && trackers_.count(name) == 0) return;
  const auto [entry, is_new] = trackers_.try_emplace(name);
  Tracker& tracker = entry->second;
  if (is_new) tracker.number = static_cast<std::uint32_t>(trackers_.size());
  tracker.starts.take(associations);
  for (auto& [key, source] : sources_) {
    if (key.first != associations.sensor) continue;
    const auto shot = std::find_if(source.shots.rbegin(), source.shots.rend(), [&](const Shot& other) {
      return other.header.stamp == associations.header.stamp;
    });
    for (const sightline::Association& association : associations.associations) {
      if (association.decision != sightline::Association::ACCEPTED) continue;
      source.record.takeInnovation(association.distance_squared);
      if (shot == source.shots.rend() || association.sighting >= shot->sightings.size()) continue;
      shot->sightings[association.sighting].track =
          std::uint64_t{tracker.number} << 32U | std::uint64_t{association.track};
    }
  }
}

std::vector<InputExamination::Row> InputExamination::sensors() const {
  std::vector<Row> rows;
  for (const auto& [key, source] : sources_) rows.push_back({key.first, key.second, &source.record});
  return rows;
}

std::vector<Finding> InputExamination::findings(const tf2::BufferCore& transforms,
                                                const std::string& tracking_frame,
                                                const InputLimits& limits) {
  turn(transforms, tracking_frame);
  std::vector<Finding> found;
  for (const auto& [key, source] : sources_) {
    for (Finding& finding : source.record.findings(subjectOf(key), limits))
      found.push_back(std::move(finding));
  }
  findSharedNames(found);
  findTransforms(transforms, tracking_frame, found);
  findScatter(found);
  findStarts(found);
  if (!limits.stand_apart) findSeparateViews(found);
  return found;
}

std::string InputExamination::subjectOf(const Key& key) const {
  return (key.first.empty() ? "(no name)" : key.first) + " on " + key.second;
}

void InputExamination::findSharedNames(std::vector<Finding>& found) const {
  std::map<std::string, std::set<std::string>> topics;
  for (const auto& [key, source] : sources_) {
    topics[key.first].insert(key.second);
    if (source.publishers.size() < 2) continue;
    found.push_back({subjectOf(key), "two sensors have one name, or one sensor has two drivers: " +
                                         listOf(source.publishers) + " publish as \"" + key.first +
                                         "\"; give every sensor a name and a topic of its own"});
  }
  for (const auto& [sensor, of_sensor] : topics) {
    if (of_sensor.size() < 2 || sensor.empty()) continue;
    found.push_back({sensor, "two sensors have one name: it comes on " + listOf(of_sensor) +
                                 "; trackers take them for one, give every sensor a name of its own"});
  }
}

void InputExamination::findTransforms(const tf2::BufferCore& transforms, const std::string& tracking_frame,
                                      std::vector<Finding>& found) const {
  for (const auto& [key, source] : sources_) {
    std::size_t there = 0, asked = 0;
    std::string frame, why;
    for (const Shot& shot : source.shots) {
      if (shot.header.frame_id.empty() || shot.header.frame_id.front() == '/')
        continue;  // is reported already
      ++asked;
      if (shot.R_tracking_sensor) {
        ++there;
        continue;
      }
      frame = shot.header.frame_id;
      why = shot.why;
    }
    if (static_cast<double>(there) >= kFewTransforms * static_cast<double>(asked)) continue;
    const bool is_late = transforms.canTransform(tracking_frame, frame, ros::Time(0));
    std::ostringstream words;
    words << "its frame \"" << frame << "\" has no transform to the tracking frame \"" << tracking_frame
          << "\"";
    if (is_late)
      words << " at the stamps of " << asked - there << " of " << asked
            << " scans, though at other times: are its stamps or those of tf off, or tf too rare?";
    else
      words << ": publish it on /tf or /tf_static, or correct header.frame_id or tracking_frame";
    if (!why.empty()) words << " (" << why << ")";
    found.push_back({subjectOf(key), words.str()});
  }
}

/// Sensors whose sightings scatter more or less than their covariance states.
void InputExamination::findScatter(std::vector<Finding>& found) const {
  for (const auto& [key, source] : sources_) {
    const auto ratio = scatterOf(source);
    const auto stated = source.record.statedSigma();
    if (!ratio || !stated || (*ratio<kTooSmall&& * ratio> kTooLarge)) continue;
    const bool is_too_small = *ratio >= kTooSmall;
    found.push_back({subjectOf(key),
                     std::string("its covariance is too ") + (is_too_small ? "small" : "large") + ": " +
                         scatterText(*stated, *ratio) + "; state that (variances are in rad^2)" +
                         (is_too_small ? "" : ", unless its errors vary slowly or sightings are smoothed")});
  }
}

/// In the tracking frame, where the platform's motion is no scatter, and along each target: the only sighting
/// of each scan, or those that one track took.
std::optional<double> InputExamination::scatterOf(const Source& source) {
  core::Scatter scatter;
  std::map<std::uint64_t, core::Scatter::Chain> chains;  // by track; 0: of scans with one sighting
  for (const Shot& shot : source.shots) {
    if (!shot.R_tracking_sensor) continue;
    const bool is_alone = shot.sightings.size() == 1;
    for (const Seen& seen : shot.sightings) {
      if (!seen.is_usable || (!is_alone && seen.track == 0)) continue;
      const core::Sighting turned =
          core::rotate(core::sightingOf(seen.angles, seen.covariance), *shot.R_tracking_sensor);
      scatter.add(chains[is_alone ? 0 : seen.track], toCore(shot.header.stamp),
                  core::anglesOf(turned.direction), core::anglesCovariance(turned));
    }
  }
  return scatter.ratio();
}

std::vector<core::Glimpse> InputExamination::glimpsesOf(const Source& source, Reading reading) {
  std::vector<core::Glimpse> glimpses;
  for (const Shot& shot : source.shots) {
    if (!shot.R_tracking_sensor) continue;
    for (const Seen& seen : shot.sightings) {
      if (!seen.is_usable) continue;
      glimpses.push_back(
          {toCore(shot.header.stamp), *shot.R_tracking_sensor * core::directionOf(reading(seen.angles))});
    }
  }
  std::sort(glimpses.begin(), glimpses.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return glimpses;
}

/// Sensors whose sightings start tracks that are never confirmed, in whatever tracker.
void InputExamination::findStarts(std::vector<Finding>& found) const {
  std::map<std::string, std::optional<Finding>> of_sensors;
  for (const auto& [name, tracker] : trackers_) {
    for (const auto& [sensor, finding] : tracker.starts.findings()) {
      const auto known = of_sensors.try_emplace(sensor, finding).first;
      if (!finding) known->second.reset();
    }
  }
  for (const auto& [sensor, finding] : of_sensors) {
    if (finding) found.push_back(*finding);
  }
}

/// Sensors that never see what any other sees. They may look elsewhere, unless another reading of their
/// angles agrees with the others.
void InputExamination::findSeparateViews(std::vector<Finding>& found) const {
  std::map<Key, std::vector<core::Glimpse>> seen;
  for (const auto& [key, source] : sources_) {
    if (!source.record.isMostlyRefused()) seen[key] = glimpsesOf(source, asSent);
  }
  for (const auto& [key, source] : sources_) {
    if (source.record.isMostlyRefused()) continue;  // is reported already
    std::vector<core::Glimpse> others;
    for (const auto& [other, glimpses] : seen) {
      if (other.first != key.first) others.insert(others.end(), glimpses.begin(), glimpses.end());
    }
    std::sort(others.begin(), others.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
    const double sigma = source.record.statedSigma().value_or(0.0);
    const double reach = std::max(kLeastReach, kReachSigmas * sigma);
    const auto distance = core::separation(seen[key], others);
    if (!distance || *distance <= reach) continue;
    std::string hint =
        "does it look elsewhere, or are its frame or axes wrong (x forward, y left, z up; azimuth "
        "counter-clockwise)?";
    bool is_explained = false;
    double best = std::min(reach, std::max(kAgreement, sigma));
    for (const Mistake& mistake : kMistakes) {
      const auto glimpses = glimpsesOf(source, mistake.reading);
      const auto nearer = core::separation(glimpses, others);
      if (!nearer || *nearer >= best) continue;
      best = *nearer;
      hint = mistake.words;
      is_explained = true;
    }
    found.push_back({subjectOf(key),
                     "what it sees is " + valueOf(*distance, "rad") +
                         " from anything that the other sensors see at the same time: " + hint,
                     !is_explained});
  }
}

std::vector<Finding> InputExamination::silentTopics(const GraphView& graph, double seconds) const {
  std::vector<Finding> found;
  for (const GraphView::Topic& topic : sightingTopics(graph)) {
    const bool spoke = std::any_of(sources_.begin(), sources_.end(),
                                   [&](const auto& source) { return source.first.second == topic.name; });
    if (spoke || topic.publishers.empty()) continue;
    found.push_back({topic.name, "is published by " + listOf(topic.publishers) +
                                     ", but no scan came within " + valueOf(seconds, "s") +
                                     ": is the sensor on? An exposure that shows nothing is an empty scan"});
  }
  return found;
}

}  // namespace sightline_ros
