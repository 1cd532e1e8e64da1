#include "sightline/core/evaluation/evaluation.h"

#include <algorithm>
#include <cmath>

namespace sightline::core {
namespace {

constexpr double kSigmasOfMatch = 10.0;
constexpr double kMatchGateWithoutSigma = 0.1;  // [rad]
constexpr double kSecondsPerHour = 3600.0;

void fillErrors(EvaluationRow& row, const ErrorStatistics& errors, double best_sigma) {
  row.samples = errors.samples();
  row.dimensions = errors.dimensions();
  row.rmse = errors.rmse();
  row.relative_rmse = row.rmse / best_sigma;
  row.rate_rmse = errors.rateRmse();
  row.anees_position = errors.aneesPosition();
  row.anees_state = errors.aneesState();
}

EvaluationRow rowOf(const SightingScore& score, double best_sigma) {
  EvaluationRow row;
  row.kind = EvaluationRow::Kind::sightings;
  row.topic = score.topic();
  row.name = score.sensor();
  fillErrors(row, score.errors(), best_sigma);
  row.coverage = kUnknown;
  row.unmatched = score.unmatched();
  row.stated_sigma = score.statedSigma();
  row.angles_now.setConstant(kUnknown);
  row.error_now = score.lastError();
  return row;
}

void fillLives(EvaluationRow& row, const TrackScore& score) {
  row.tracks = score.lives().tracks();
  row.false_tracks = score.lives().falseTracks();
  row.scored_time = score.scoredTime();
  if (row.scored_time > 0.0)
    row.false_tracks_per_hour = kSecondsPerHour * static_cast<double>(row.false_tracks) / row.scored_time;
  row.purity = score.lives().purity();
  row.completeness = score.appearances().completeness();
  row.appearances = score.appearances().count();
  row.never_confirmed = score.appearances().neverConfirmed();
  row.confirm_median = score.appearances().medianDelay();
  row.confirm_worst = score.appearances().worstDelay();
}

EvaluationRow rowOf(const TrackScore& score, double best_sigma) {
  EvaluationRow row;
  row.kind = score.fused() ? EvaluationRow::Kind::fused_tracks : EvaluationRow::Kind::tracks;
  row.topic = score.topic();
  row.name = score.tracker();
  fillErrors(row, score.errors(), best_sigma);
  row.coverage = score.continuity().coverage();
  row.breaks = score.continuity().breaks();
  row.id_switches = score.continuity().idSwitches();
  row.unmatched = score.unmatched();
  row.stated_sigma = kUnknown;
  row.gospa = score.gospaMeans();
  row.ospa = score.ospaMean().mean();
  fillLives(row, score);
  row.tracks_now = score.tracksNow();
  row.angles_now = score.anglesNow();
  row.error_now = score.lastError();
  return row;
}

TargetRow rowOf(const TrackScore& topic, std::uint32_t target, const TargetScore& score) {
  TargetRow row;
  row.topic = topic.topic();
  row.name = topic.tracker();
  row.target = target;
  row.samples = score.errors.samples();
  row.dimensions = score.errors.dimensions();
  row.rmse = score.errors.rmse();
  row.rate_rmse = score.errors.rateRmse();
  row.anees_position = score.errors.aneesPosition();
  row.anees_state = score.errors.aneesState();
  row.coverage = score.coverage();
  row.breaks = score.breaks;
  row.id_switches = score.id_switches;
  return row;
}

}  // namespace

void Evaluation::addTruth(Time time, const std::map<std::uint32_t, Eigen::Vector4d>& motions) {
  const Duration memory = durationOf(params_.truth_memory);
  if (newest_truth_ && time < *newest_truth_ - memory) forgetTruth();

  for (const auto& [id, motion] : motions) {
    if (!motion.allFinite()) continue;
    TruthSample sample{time, motion};
    if (params_.channels == Channels::azimuth_only) sample.motion(1) = sample.motion(3) = 0.0;
    truth_.try_emplace(id, durationOf(params_.truth_gap)).first->second.add(sample);
  }
  newest_truth_ = newest_truth_ ? std::max(*newest_truth_, time) : time;
  oldest_truth_ = oldest_truth_ ? std::min(*oldest_truth_, time) : time;

  for (SightingTopic& topic : sighting_topics_) scoreReady(topic);
  for (TrackTopic& topic : track_topics_) scoreReady(topic);

  oldest_truth_ = std::max(*oldest_truth_, *newest_truth_ - memory);
  for (auto path = truth_.begin(); path != truth_.end();) {
    path->second.forgetBefore(*oldest_truth_);
    path = path->second.empty() ? truth_.erase(path) : std::next(path);
  }
}

void Evaluation::forgetTruth() {
  truth_.clear();
  oldest_truth_ = newest_truth_ = std::nullopt;
  const auto dropWaiting = [](auto& topic) {
    topic.unscored += topic.waiting.size();
    topic.waiting.clear();
  };
  std::for_each(sighting_topics_.begin(), sighting_topics_.end(), dropWaiting);
  std::for_each(track_topics_.begin(), track_topics_.end(), dropWaiting);
  for (TrackTopic& topic : track_topics_) topic.score.restart();
}

void Evaluation::expectSightings(const std::string& topic) {
  sightingTopic(topic, "");
}

void Evaluation::expectTracks(const std::string& topic) {
  trackTopic(topic);
}

void Evaluation::addScan(const std::string& topic, Scan scan) {
  SightingTopic& entry = sightingTopic(topic, scan.sensor);
  entry.score.note(scan);
  await(entry, std::move(scan));
}

void Evaluation::addTracks(const std::string& topic, TrackReport report) {
  TrackTopic& entry = trackTopic(topic);
  entry.score.note(report);
  await(entry, std::move(report));
}

Evaluation::SightingTopic& Evaluation::sightingTopic(const std::string& topic, const std::string& sensor) {
  for (SightingTopic& entry : sighting_topics_) {
    if (entry.score.topic() != topic) continue;
    if (entry.score.sensor().empty() && !sensor.empty()) {  // the first sensor of an expected topic
      entry.score = SightingScore(topic, sensor, params_.channels);
    }
    if (entry.score.sensor() == sensor) return entry;
  }
  return sighting_topics_.emplace_back(SightingTopic{SightingScore(topic, sensor, params_.channels), {}, 0});
}

Evaluation::TrackTopic& Evaluation::trackTopic(const std::string& topic) {
  for (TrackTopic& entry : track_topics_) {
    if (entry.score.topic() == topic) return entry;
  }
  return track_topics_.emplace_back(TrackTopic{TrackScore(topic, params_.channels, params_.gospa), {}, 0});
}

template <typename Score, typename Message>
void Evaluation::await(Topic<Score, Message>& topic, Message message) {
  topic.waiting.push_back(std::move(message));
  while (topic.waiting.back().time - topic.waiting.front().time > durationOf(params_.truth_memory)) {
    topic.waiting.pop_front();
    ++topic.unscored;
  }
  scoreReady(topic);
}

template <typename Score, typename Message>
void Evaluation::scoreReady(Topic<Score, Message>& topic) {
  while (!topic.waiting.empty() && newest_truth_ && topic.waiting.front().time <= *newest_truth_) {
    const Message& message = topic.waiting.front();
    if (message.time < *oldest_truth_) {
      ++topic.unscored;
    } else {
      score(topic, message);
      last_scored_ = last_scored_ ? std::max(*last_scored_, message.time) : message.time;
    }
    topic.waiting.pop_front();
  }
}

void Evaluation::score(SightingTopic& topic, const Scan& scan) {
  topic.score.add(scan, targetsAt(scan.time), {params_.sighting_gate, params_.sighting_gate_floor},
                  listener_);
}

void Evaluation::score(TrackTopic& topic, const TrackReport& report) {
  topic.score.add(report, targetsAt(report.time), matchGate(), listener_);
}

std::vector<TrueTarget> Evaluation::targetsAt(Time time) const {
  std::vector<TrueTarget> targets;
  for (const auto& [id, path] : truth_) {
    if (const auto point = path.at(time)) {
      targets.push_back({id, point->state, point->age >= params_.settle_time, point->age});
    }
  }
  return targets;
}

double Evaluation::matchGate() const {
  if (params_.match_gate > 0.0) return params_.match_gate;
  double coarsest = 0.0;
  for (const SightingTopic& topic : sighting_topics_)
    coarsest = std::fmax(coarsest, topic.score.statedSigma());
  return coarsest > 0.0 ? kSigmasOfMatch * coarsest : kMatchGateWithoutSigma;
}

double Evaluation::bestSigma() const {
  double best = kUnknown;  // std::fmin passes NaN over
  for (const SightingTopic& topic : sighting_topics_) best = std::fmin(best, topic.score.statedSigma());
  return best;
}

std::vector<EvaluationRow> Evaluation::rows() const {
  const double best_sigma = bestSigma();
  std::vector<EvaluationRow> rows;
  const auto addRow = [&](const auto& topic) {
    rows.push_back(rowOf(topic.score, best_sigma));
    rows.back().unscored = topic.unscored + topic.waiting.size();
  };
  std::for_each(sighting_topics_.begin(), sighting_topics_.end(), addRow);
  std::for_each(track_topics_.begin(), track_topics_.end(), addRow);
  std::stable_sort(rows.begin(), rows.end(),
                   [](const EvaluationRow& a, const EvaluationRow& b) { return a.kind < b.kind; });
  return rows;
}

std::vector<const TrackScore*> Evaluation::trackScores() const {
  std::vector<const TrackScore*> scores;
  for (const TrackTopic& topic : track_topics_) scores.push_back(&topic.score);
  std::stable_sort(scores.begin(), scores.end(),
                   [](const TrackScore* a, const TrackScore* b) { return a->fused() < b->fused(); });
  return scores;
}

std::vector<TargetRow> Evaluation::targetRows() const {
  std::vector<TargetRow> rows;
  for (const TrackScore* topic : trackScores()) {
    for (const auto& [target, score] : topic->targets()) rows.push_back(rowOf(*topic, target, score));
  }
  return rows;
}

}  // namespace sightline::core
