#include "sightline/ros/inspector/inspector_model.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sightline/core/evaluation/metrics.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

constexpr double kBeginsAgain = 1.0;  // backwards, from which a recording begins again [s]
constexpr double kDimension = 2.0;    // of an innovation
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

float gateOf(const sightline::Track& track) {
  return static_cast<float>(std::max(track.gate.azimuth_half_width, track.gate.elevation_half_width));
}
float gateOf(const sightline::PositionTrack&) {
  return kUnknown;
}

/// Source "tracker/id" of a position; the tracker's name may hold slashes.
std::optional<std::pair<std::string, std::uint32_t>> trackerAndId(const std::string& source) {
  const std::size_t slash = source.rfind('/');
  if (slash == std::string::npos) return std::nullopt;
  const auto id = sightline::report::numberFrom(source.substr(slash + 1));
  if (!id || !(*id >= 0.0) || !(*id < 4294967296.0)) return std::nullopt;
  return std::make_pair(source.substr(0, slash), static_cast<std::uint32_t>(*id));
}

template <typename Tracks>
std::optional<std::size_t> placeOf(const Tracks& tracks, std::uint32_t id) {
  const auto found =
      std::find_if(tracks.begin(), tracks.end(), [id](const auto& track) { return track.id == id; });
  if (found == tracks.end()) return std::nullopt;
  return static_cast<std::size_t>(found - tracks.begin());
}

SupportRow supportOf(const sightline::SourceTrack& source) {
  return {source.tracker, source.id, source.weight, source.distance_squared, source.reason};
}

}  // namespace

/// Whether what comes now is taken in.
bool InspectorModel::begin(core::Time now) {
  if (is_frozen_) return false;
  if (core::seconds(now_ - now) > kBeginsAgain) {
    topics_.clear();
    reports_.clear();
    log_.clear();
    samples_.clear();
    selected_samples_.clear();
    board_.clear();
    topics_left_out_ = 0;
    followSelected();
  }
  now_ = now;
  return true;
}

void InspectorModel::tick(core::Time now) {
  if (!begin(now)) return;
  for (auto topic = topics_.begin(); topic != topics_.end();) {
    const bool is_over = core::seconds(now - topic->second.arrival) > kForgotten;
    topic = is_over ? topics_.erase(topic) : std::next(topic);
  }
}

/// The topic with its new stamp, and samples of its tracks; nullptr when there are too many topics.
template <typename Message>
InspectorModel::Topic* InspectorModel::renew(const std::string& name, const Message& tracks, core::Time now) {
  if (topics_.count(name) == 0 && topics_.size() >= kMostTopics) {
    ++topics_left_out_;
    return nullptr;
  }
  Topic& topic = topics_[name];
  const core::Time stamp = toCore(tracks.header.stamp);
  if (core::seconds(topic.stamp - stamp) > kBeginsAgain) topic.memos.clear();
  topic.arrival = now;
  topic.stamp = stamp;
  topic.tracker = tracks.tracker;
  const std::uint16_t index = sample_topics_.indexOf(name);
  std::map<std::uint32_t, Memo> memos;
  for (std::size_t i = 0; i < std::min(tracks.tracks.size(), kMostTracks); ++i) {
    const auto& track = tracks.tracks[i];
    const auto known = topic.memos.find(track.id);
    Memo memo = known != topic.memos.end() ? known->second : Memo{stamp, {}};
    if (core::seconds(stamp - memo.sample) >= kSamplePeriod) {
      memo.sample = stamp;
      const auto sigma = static_cast<float>(sigmaOfTrack(track));
      const Sample sample{now, stamp, track.id, index, sigma, gateOf(track)};
      samples_.add(sample);
      if (isOfSelected(sample)) selected_samples_.add(sample);
    }
    memos.emplace_hint(memos.end(), track.id, memo);
  }
  topic.memos = std::move(memos);
  return &topic;
}

void InspectorModel::take(const std::string& name, const sightline::TrackArray::ConstPtr& tracks,
                          core::Time now) {
  if (!begin(now)) return;
  Topic* topic = renew(name, *tracks, now);
  if (topic != nullptr) topic->directions = tracks;
}

void InspectorModel::take(const std::string& name, const sightline::PositionTrackArray::ConstPtr& tracks,
                          core::Time now) {
  if (!begin(now)) return;
  Topic* topic = renew(name, *tracks, now);
  if (topic == nullptr) return;
  topic->positions = tracks;
  if (selected_ && selected_->topic == name) followSelected();
}

void InspectorModel::take(const std::string& topic, const sightline::AssociationArray& decisions,
                          core::Time now) {
  if (!begin(now)) return;
  log_.take(topic, decisions, now);
  board_.take(topic, decisions, now);
}

void InspectorModel::take(const std::string& topic, const sightline::FusionReport::ConstPtr& report,
                          core::Time now) {
  if (!begin(now)) return;
  const std::string space = spaceOf(topic);
  if (reports_.count(space) == 0 && reports_.size() >= kMostTopics) return;
  reports_[space] = report;
  board_.take(topic, *report, now);
  if (selected_ && spaceOf(selected_->topic) == space) followSelected();
}

void InspectorModel::take(const diagnostic_msgs::DiagnosticArray& diagnostics, core::Time now) {
  if (begin(now)) board_.take(diagnostics, now);
}

void InspectorModel::select(const std::optional<TrackKey>& key) {
  selected_ = key;
  selected_samples_.clear();
  for (const Sample& sample : samples_) {
    if (isOfSelected(sample)) selected_samples_.add(sample);
  }
  followSelected();
}

bool InspectorModel::isOfSelected(const Sample& sample) const {
  return selected_ && sample.track == selected_->id &&
         sample_topics_.names()[sample.topic] == selected_->topic;
}

/// The log follows the selected track, or the local tracks that support it.
void InspectorModel::followSelected() {
  std::set<TrackInSpace> tracks;
  if (!selected_) return log_.follow(tracks);
  std::vector<std::pair<std::string, std::uint32_t>> sources;  // trackers and ids
  if (const sightline::FusedTrack* fused = fusedTrack(*selected_)) {
    for (const auto& source : fused->sources) sources.emplace_back(source.tracker, source.id);
  } else if (const auto row = rowOfTrack(*selected_); row && row->kind == TrackKind::position) {
    for (const std::string& source : row->sources) {
      if (auto found = trackerAndId(source)) sources.push_back(std::move(*found));
    }
  } else {
    tracks.emplace(spaceOf(selected_->topic), selected_->id);
  }
  for (const auto& [tracker, id] : sources) {
    const std::string topic = topicOfTracker(tracker);
    if (!topic.empty()) tracks.emplace(spaceOf(topic), id);
  }
  log_.follow(tracks);
}

std::string InspectorModel::topicOfTracker(const std::string& tracker) const {
  const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const auto& named) {
    return named.second.directions && named.second.tracker == tracker;
  });
  return found == topics_.end() ? "" : found->first;
}

std::string InspectorModel::trackerOfSpace(const std::string& space) const {
  const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const auto& named) {
    return named.second.directions && spaceOf(named.first) == space;
  });
  return found == topics_.end() ? space : found->second.tracker;
}

const sightline::FusedTrack* InspectorModel::fusedTrack(const TrackKey& key) const {
  const auto report = reports_.find(spaceOf(key.topic));
  if (report == reports_.end()) return nullptr;
  const auto place = placeOf(report->second->tracks, key.id);
  return place ? &report->second->tracks[*place] : nullptr;
}

TrackRow InspectorModel::completed(const std::string& name, const Topic& topic, TrackRow row) const {
  if (row.kind == TrackKind::local && reports_.count(spaceOf(name)) > 0) row.kind = TrackKind::global;
  const auto memo = topic.memos.find(row.key.id);
  if (memo != topic.memos.end()) row.age = core::seconds(topic.stamp - memo->second.first);
  const double silence = core::seconds(now_ - topic.arrival);
  row.silence = silence > kSilence ? silence : 0.0;
  return row;
}

std::vector<TrackRow> InspectorModel::rows() const {
  std::vector<TrackRow> rows;
  for (const auto& [name, topic] : topics_) {
    const auto add = [&rows, &topic = topic, &name = name, this](const auto& message) {
      for (std::size_t i = 0; i < std::min(message.tracks.size(), kMostTracks); ++i)
        rows.push_back(completed(name, topic, rowOf(name, message, i)));
    };
    if (topic.positions)
      add(*topic.positions);
    else if (topic.directions)
      add(*topic.directions);
  }
  const auto rank = [](const TrackRow& row) {
    return row.kind == TrackKind::global ? 0 : row.kind == TrackKind::position ? 1 : 2;
  };
  std::stable_sort(rows.begin(), rows.end(),
                   [&rank](const TrackRow& a, const TrackRow& b) { return rank(a) < rank(b); });
  return rows;
}

std::optional<TrackRow> InspectorModel::rowOfTrack(const TrackKey& key) const {
  const auto topic = topics_.find(key.topic);
  if (topic == topics_.end()) return std::nullopt;
  const auto find = [&](const auto& message) -> std::optional<TrackRow> {
    const auto place = placeOf(message.tracks, key.id);
    if (!place) return std::nullopt;
    return completed(key.topic, topic->second, rowOf(key.topic, message, *place));
  };
  if (topic->second.positions) return find(*topic->second.positions);
  if (topic->second.directions) return find(*topic->second.directions);
  return std::nullopt;
}

/// What ages are counted from: the newest stamp of the selected track's topic, for a recording's stamps need
/// not be near the clock.
core::Time InspectorModel::stampNow() const {
  const auto topic = selected_ ? topics_.find(selected_->topic) : topics_.end();
  return topic == topics_.end() ? now_ : topic->second.stamp;
}

std::optional<TrackDetail> InspectorModel::detail() const {
  if (!selected_) return std::nullopt;
  TrackDetail detail;
  detail.key = *selected_;
  detail.row = rowOfTrack(*selected_);
  detail.sensors = log_.sensors();
  const core::Time now = stampNow();

  std::map<std::uint16_t, SensorGate> gates;
  double sum = 0.0;
  detail.sightings.reserve(log_.followed().size());
  for (const SightingRecord& record : log_.followed()) {
    if (!std::isfinite(record.distance_squared)) continue;
    const auto age = static_cast<float>(core::seconds(now - record.stamp));
    const bool is_taken = record.decision == sightline::Association::ACCEPTED;
    detail.sightings.push_back(
        {age, record.innovation[0], record.innovation[1], record.distance_squared, record.sensor, is_taken});
    if (!is_taken) continue;
    gates[record.sensor] = {record.sensor, record.covariance, record.threshold};
    ++detail.nis.count;
    sum += record.distance_squared;
  }
  for (const auto& [sensor, gate] : gates) detail.gates.push_back(gate);
  if (detail.nis.count > 0) {
    const auto count = static_cast<double>(detail.nis.count);
    const core::Band band = core::aneesBand(kDimension * count);
    detail.nis.mean = sum / count;
    detail.nis.low = kDimension * band.low;
    detail.nis.high = kDimension * band.high;
  }
  for (const Sample& sample : selected_samples_) {
    detail.spread.push_back(
        {static_cast<float>(core::seconds(now - sample.stamp)), sample.sigma, sample.gate});
  }
  return detail;
}

std::vector<SightingLine> InspectorModel::sightings(std::size_t most) const {
  std::vector<SightingLine> lines;
  if (!selected_) return lines;
  const core::Time now = stampNow();
  const auto& followed = log_.followed();
  for (auto record = followed.rbegin(); record != followed.rend() && lines.size() < most; ++record) {
    SightingLine line;
    line.age = core::seconds(now - record->stamp);
    line.sensor = log_.sensors()[record->sensor];
    line.tracker = trackerOfSpace(log_.spaces()[record->space]) + '/' + std::to_string(record->track);
    line.decision = decisionWord(*record);
    line.reason = reasonOf(*record);
    line.is_taken = record->decision == sightline::Association::ACCEPTED;
    lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<SupportRow> InspectorModel::support() const {
  std::vector<SupportRow> rows;
  if (!selected_) return rows;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const auto row = rowOfTrack(*selected_);
  if (const sightline::FusedTrack* fused = fusedTrack(*selected_)) {
    for (const auto& source : fused->sources) {
      rows.push_back(supportOf(source));
      rows.back().words = "by the rule " + fused->rule;
      if (!fused->why_not_tracklets.empty())
        rows.back().words += " (not tracklets: " + fused->why_not_tracklets + ')';
    }
    for (const auto& source : fused->left_out) {
      rows.push_back(supportOf(source));
      rows.back().words = "left out: " + source.reason;
    }
  } else if (row && row->kind == TrackKind::position) {
    for (const std::string& source : row->sources) {
      if (const auto found = trackerAndId(source))
        rows.push_back({found->first, found->second, unknown, unknown, "its ray crosses there"});
    }
  } else if (row) {
    for (const std::string& sensor : row->sources) rows.push_back({sensor, 0, unknown, unknown, "sees it"});
    addSupported(*row, rows);
  }
  return rows;
}

/// The global tracks that a local track is a part of, or why it is part of none.
void InspectorModel::addSupported(const TrackRow& local, std::vector<SupportRow>& rows) const {
  const auto is_local = [&](const sightline::SourceTrack& source) {
    return source.tracker == local.tracker && source.id == local.key.id;
  };
  const auto addFrom = [&](const std::vector<sightline::SourceTrack>& sources, const std::string& place) {
    const auto found = std::find_if(sources.begin(), sources.end(), is_local);
    if (found == sources.end()) return;
    rows.push_back(supportOf(*found));
    rows.back().words = place + (found->reason.empty() ? "" : ": " + found->reason);
  };
  for (const auto& [space, report] : reports_) {
    const std::string fusion = trackerOfSpace(space);
    for (const auto& fused : report->tracks) {
      const std::string name = fusion + '/' + std::to_string(fused.id);
      addFrom(fused.sources, "it supports " + name);
      addFrom(fused.left_out, "left out of " + name);
    }
    addFrom(report->left_out, "in no track of " + fusion);
  }
}

std::string InspectorModel::notice() const {
  if (topics_left_out_ == 0) return "";
  return "more than " + std::to_string(kMostTopics) + " topics of tracks: further ones are not shown";
}

}  // namespace sightline_ros
