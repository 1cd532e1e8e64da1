#include "sightline/ros/inspector/sensor_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

/// How a local tracker's /diagnostics speak of a sensor: "guard of NAME".
const std::array<const char*, 8> kKinds = {"guard",   "noise",     "clock", "stamps",
                                           "latency", "detection", "input", "track starts"};

/// Kind and sensor of "noise of left"; nullopt of any other key.
std::optional<std::pair<std::string, std::string>> kindAndSensor(const std::string& key) {
  for (const std::string kind : kKinds) {
    const std::string start = kind + " of ";
    if (key.size() > start.size() && key.rfind(start, 0) == 0)
      return std::make_pair(kind, key.substr(start.size()));
  }
  return std::nullopt;
}

/// "a; b" of those that say something.
std::string together(const std::map<std::string, std::string>& said, const std::vector<std::string>& kinds) {
  std::string text;
  for (const std::string& kind : kinds) {
    const auto words = said.find(kind);
    if (words != said.end() && !words->second.empty()) text += (text.empty() ? "" : "; ") + words->second;
  }
  return text;
}

/// The verdict without the values that go on changing: up to ", now 2.31 times".
std::string lasting(const std::string& verdict) {
  return verdict.substr(0, verdict.find(", now "));
}

/// Of a tracker, "healthy", or of the fusion, "track 7: healthy".
bool isHealthy(const std::string& verdict) {
  const std::size_t colon = verdict.rfind("track ", 0) == 0 ? verdict.find(": ") : std::string::npos;
  return verdict.empty() || verdict.compare(colon == std::string::npos ? 0 : colon + 2, 7, "healthy") == 0;
}

bool isSuspect(const sightline::SensorHealth& health) {
  return health.verdict != "healthy" || std::isfinite(health.clock_behind);
}

std::string rounded(double value, int digits = 3) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

std::string clockOf(const sightline::SensorHealth& health) {
  if (!std::isfinite(health.clock_behind)) return "";
  return sightline::report::valueOf(std::abs(health.clock_behind), "s") +
         (health.clock_behind > 0.0 ? " behind the others" : " ahead of the others");
}

std::string biasOf(const sightline::SensorHealth& health) {
  if (health.verdict == "healthy") return "";
  return '(' + rounded(health.bias[0], 2) + ", " + rounded(health.bias[1], 2) + ") sigma";
}

std::string noiseOf(const sightline::SensorHealth& health) {
  if (!std::isfinite(health.noise_scale)) return "not used";
  return rounded(std::sqrt(health.noise_scale)) + " times the stated sigma";
}

}  // namespace

SensorBoard::Opinion* SensorBoard::opinionOf(const std::string& sensor, const std::string& by) {
  const auto known = opinions_.find({sensor, by});
  if (known != opinions_.end()) return &known->second;
  if (opinions_.size() >= kMostRows) return nullptr;
  Opinion& opinion = opinions_[{sensor, by}];
  opinion.row.sensor = sensor;
  opinion.row.by = by;
  return &opinion;
}

void SensorBoard::note(core::Time now, const std::string& sensor, const std::string& by,
                       const std::string& words) {
  changes_.push_back({now, sensor, by, words});
  if (changes_.size() > kMostChanges) changes_.pop_front();
}

void SensorBoard::take(const diagnostic_msgs::DiagnosticArray& diagnostics, core::Time now) {
  for (const auto& status : diagnostics.status) {
    const std::string by = status.name.substr(0, status.name.find(": "));
    std::map<std::string, std::map<std::string, std::string>> said;  // by sensor, then kind
    for (const auto& value : status.values) {
      if (const auto key = kindAndSensor(value.key)) said[key->second][key->first] = value.value;
    }
    for (auto& [sensor, words] : said) {
      Opinion* opinion = opinionOf(sensor, by);
      if (opinion == nullptr) continue;
      const bool was_known = opinion->said.count("guard") > 0;
      const std::string before = lasting(opinion->said["guard"]), after = lasting(words["guard"]);
      if (before != after && (was_known || !isHealthy(after))) note(now, sensor, by, words["guard"]);
      opinion->said = std::move(words);
      opinion->time = now;
      SensorRow& row = opinion->row;
      row.verdict = together(opinion->said, {"guard"});
      row.noise = together(opinion->said, {"noise"});
      row.clock = together(opinion->said, {"clock", "stamps", "latency"});
      row.detection = together(opinion->said, {"detection", "input", "track starts"});
      row.is_suspect =
          !isHealthy(row.verdict) || !together(opinion->said, {"clock", "stamps", "input"}).empty();
    }
  }
}

void SensorBoard::take(const std::string& topic, const sightline::FusionReport& report, core::Time now) {
  std::map<std::string, std::pair<std::uint32_t, const sightline::SensorHealth*>> worst;  // by sensor
  for (const auto& track : report.tracks) {
    for (const auto& health : track.sensors) {
      auto& kept = worst[health.sensor];
      if (kept.second == nullptr || (isSuspect(health) && !isSuspect(*kept.second)))
        kept = {track.id, &health};
    }
    for (const auto& change : track.sensor_changes)
      note(now, change.sensor, topic, "track " + std::to_string(track.id) + ": " + change.reason);
  }
  for (const auto& [sensor, found] : worst) {
    Opinion* opinion = opinionOf(sensor, topic);
    if (opinion == nullptr) continue;
    const sightline::SensorHealth& health = *found.second;
    SensorRow& row = opinion->row;
    opinion->time = now;
    row.is_suspect = isSuspect(health);
    row.verdict = health.reason.empty() ? health.verdict : health.reason;
    if (row.is_suspect) row.verdict = "track " + std::to_string(found.first) + ": " + row.verdict;
    row.noise = noiseOf(health);
    row.bias = biasOf(health);
    row.clock = clockOf(health);
  }
}

void SensorBoard::take(const std::string& topic, const sightline::AssociationArray& decisions,
                       core::Time now) {
  std::uint64_t rejected = 0;
  std::string reason;
  for (const auto& row : decisions.associations) {
    if (row.decision != sightline::Association::REJECTED_INPUT) continue;
    ++rejected;
    reason = row.reason;
  }
  if (rejected == 0) return;
  Opinion* opinion = opinionOf(decisions.sensor, topic);
  if (opinion == nullptr) return;
  opinion->rejected += rejected;
  opinion->time = now;
  opinion->row.is_suspect = true;
  opinion->row.detection =
      std::to_string(opinion->rejected) + " sightings rejected, the last one because " + reason;
}

void SensorBoard::clear() {
  opinions_.clear();
  changes_.clear();
}

std::vector<SensorRow> SensorBoard::rows(core::Time now) const {
  std::vector<SensorRow> rows;
  rows.reserve(opinions_.size());
  for (const auto& [key, opinion] : opinions_) {
    rows.push_back(opinion.row);
    rows.back().silence = std::max(core::seconds(now - opinion.time), 0.0);
  }
  return rows;
}

}  // namespace sightline_ros
