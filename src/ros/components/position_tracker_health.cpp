#include "sightline/ros/components/position_tracker_health.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <diagnostic_msgs/DiagnosticStatus.h>

#include "sightline/core/model/refusal.h"

namespace sightline_ros {

namespace core = sightline::core;
using diagnostic_msgs::DiagnosticStatus;
using sightline::PositionTrack;

namespace {

constexpr double kOnePlace = 1.0;          // [m]: from closer together nothing crosses
constexpr std::size_t kMostTopics = 1024;  // of tracklets that are counted

/// Largest distance of two stations [m], 0 of one.
double spreadOf(const std::map<std::string, Eigen::Vector3d>& stations) {
  double spread = 0.0;
  for (const auto& [tracker, origin] : stations)
    spread = std::max(spread, (origin - stations.begin()->second).norm());
  return spread;
}

}  // namespace

PositionTrackerHealth::PositionTrackerHealth(const std::vector<std::string>& topics, double silence)
    : silence_(silence) {
  for (const std::string& topic : topics) sources_[topic];
}

std::vector<std::string> PositionTrackerHealth::note(const PositionResult& result, core::Time now) {
  std::vector<std::string> lines;
  if (!result.notice.empty()) lines.push_back(result.notice);
  for (const core::Refusal& refusal : result.refusals) {
    if (const auto line = refusals_.note(refusal, now)) lines.push_back(*line);
  }
  if (!result.is_tracks) {
    if (tracklets_.size() < kMostTopics || tracklets_.count(result.topic) > 0)
      tracklets_[result.topic] += result.used;
    return lines;
  }
  if (!result.tracks) return lines;
  Source& source = sources_[result.topic];
  ++source.messages;
  source.tracker = result.tracker;
  source.tracks = result.used;
  source.newest = result.stamp;
  tracks_ = result.tracks;
  report_ = result.report;
  return lines;
}

void PositionTrackerHealth::diagnose(core::Time now, const std::map<std::string, Eigen::Vector3d>& stations,
                                     std::size_t waiting,
                                     diagnostic_updater::DiagnosticStatusWrapper& status) {
  std::array<std::size_t, 3> positions{};
  if (tracks_) {
    for (const PositionTrack& track : tracks_->tracks)
      if (track.status < positions.size()) ++positions[track.status];
  }
  std::ostringstream line;
  line << positions[PositionTrack::CONFIRMED] << " positions confirmed";
  status.summary(DiagnosticStatus::OK, line.str());
  warnOfSilence(now, status);
  const double spread = spreadOf(stations);
  if (stations.size() > 1 && spread < kOnePlace) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        "all stations stand within a metre: is the tracking_frame of each local tracker that "
                        "of its station?");
  }
  status.add("positions confirmed", positions[PositionTrack::CONFIRMED]);
  status.add("positions coasting", positions[PositionTrack::COASTING]);
  status.add("positions tentative", positions[PositionTrack::TENTATIVE]);
  status.addf("largest distance of stations [m]", "%.1f", spread);
  status.add("messages that wait for transforms", waiting);

  const double elapsed = last_diagnosis_ ? core::seconds(now - *last_diagnosis_) : 0.0;
  for (auto& [topic, source] : sources_) {
    const auto fresh = static_cast<double>(source.messages - source.messages_before);
    status.add(topic + ": tracker", source.tracker.empty() ? "(nothing yet)" : source.tracker);
    status.addf(topic + ": rate [Hz]", "%.1f", elapsed > 0.0 ? fresh / elapsed : 0.0);
    if (source.messages > 0) {
      status.addf(topic + ": age of last report [s]", "%.3f", core::seconds(now - source.newest));
      status.add(topic + ": tracks", source.tracks);
    }
    source.messages_before = source.messages;
  }
  for (const auto& [topic, count] : tracklets_) status.add(topic + ": tracklets used", count);
  if (report_) {
    std::map<std::string, std::size_t> refused, unlocated;
    for (const auto& crossing : report_->refused) ++refused[crossing.kind];
    for (const auto& track : report_->unlocated) ++unlocated[track.kind];
    for (const auto& [kind, count] : refused) status.add("crossings refused now, " + kind, count);
    for (const auto& [kind, count] : unlocated) status.add("local tracks without a position, " + kind, count);
    if (!report_->complete) {
      status.mergeSummary(DiagnosticStatus::WARN,
                          "more crossings than hypotheses/most_candidates: no new positions are started");
    }
    for (const auto& station : report_->stations) {
      status.addf("slow error of " + station.tracker + "/" + station.sensor, "%.2f stated sigmas, %.1f s",
                  station.slow_scale, station.time_constant);
      if (station.corrected) {
        const double turned = std::hypot(station.rotation[0], station.rotation[1], station.rotation[2]);
        status.addf("put right: " + station.tracker + "/" + station.sensor,
                    "clock %.4f +- %.4f s behind, turned by %.2e rad", station.clock_behind,
                    station.clock_sigma, turned);
      }
      if (station.undecided) {
        status.mergeSummary(DiagnosticStatus::WARN,
                            "clock or orientation of " + station.tracker +
                                " or of another station is off, and the targets do not tell whose");
      }
    }
  }
  refusals_.diagnose(status);
  last_diagnosis_ = now;
}

void PositionTrackerHealth::warnOfSilence(core::Time now,
                                          diagnostic_updater::DiagnosticStatusWrapper& status) const {
  for (const auto& [topic, source] : sources_) {
    std::ostringstream silent;
    if (source.messages == 0) {
      silent << "nothing yet on " << topic;
    } else if (core::seconds(now - source.newest) > silence_) {
      silent << "no tracks on " << topic << " for " << core::seconds(now - source.newest) << " s";
    } else {
      continue;
    }
    status.mergeSummary(DiagnosticStatus::WARN, silent.str());
  }
}

}  // namespace sightline_ros
