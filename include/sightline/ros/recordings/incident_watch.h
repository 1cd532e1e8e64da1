#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include <sightline/FusionReport.h>
#include <sightline/TrackArray.h>

namespace sightline_ros {

/// Notices what somebody will want to look into: a believed track that ends, a sensor whose verdict changes.
/// Answers are one line for people, nullopt when nothing happened.
class IncidentWatch {
 public:
  /// `topic`: of the tracks; each is watched for itself. A track is believed once it was confirmed.
  std::optional<std::string> onTracks(const std::string& topic, const sightline::TrackArray& tracks);

  /// A change back to healthy is one, too.
  static std::optional<std::string> onReport(const sightline::FusionReport& report);

 private:
  std::map<std::string, std::set<std::uint32_t>> believed_;  // ids by topic
};

}  // namespace sightline_ros
