#include "fusion_of_many.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "sightline/core/association/assignment.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/core/tracking/tracklet_builder.h"

#include "processor_time.h"

namespace sightline::bench {
namespace {

struct Target {
  Eigen::Vector2d middle, velocity, sway;  // [rad], [rad/s], [rad]
  double frequency = 0.0, phase = 0.0;     // [rad/s], [rad]

  Eigen::Vector2d at(double t) const {
    return middle + velocity * t + sway * std::sin(frequency * t + phase);
  }
};

Eigen::Vector2d inSquare(double half_width, core::RandomStream& random) {
  const double x = 2.0 * random.uniform() - 1.0, y = 2.0 * random.uniform() - 1.0;
  return half_width * Eigen::Vector2d(x, y);
}

Eigen::Vector2d towards(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

Target targetOf(const ManyTargets& scene, core::RandomStream& random) {
  Target target;
  target.velocity = scene.fastest * (0.3 + 0.7 * random.uniform()) * towards(2.0 * M_PI * random.uniform());
  const double meets = scene.duration * random.uniform();  // at a place within the square
  target.middle = inSquare(scene.half_width, random) - meets * target.velocity;
  target.sway = 3e-3 * random.uniform() * towards(2.0 * M_PI * random.uniform());
  target.frequency = 0.5 + 0.5 * random.uniform();
  target.phase = 2.0 * M_PI * random.uniform();
  return target;
}

struct Sensor {
  std::string name;
  double sigma;
  Eigen::Vector2d bias;
  core::RandomStream random;
  core::LocalTracker tracker;
  core::TrackletBuilder tracklets;
};

core::Scan scanAt(double t, const ManyTargets& scene, const std::vector<Target>& targets, Sensor& sensor) {
  core::Scan scan;
  scan.time = core::Time(core::durationOf(t));
  scan.sensor = sensor.name;
  scan.ifov = sensor.sigma;
  const Eigen::Matrix2d R = sensor.sigma * sensor.sigma * Eigen::Matrix2d::Identity();
  for (const Target& target : targets) {
    const Eigen::Vector2d noise = sensor.sigma * sensor.random.normalPair();
    const bool seen = sensor.random.uniform() < scene.detection_probability;
    if (seen) scan.sightings.push_back(core::sightingOf(target.at(t) + sensor.bias + noise, R));
  }
  for (unsigned k = sensor.random.poisson(scene.clutter); k > 0; --k)
    scan.sightings.push_back(core::sightingOf(inSquare(scene.half_width, sensor.random), R));
  return scan;
}

/// Who has whom: the track of each target at the last look, and at all.
class Bookkeeping {
 public:
  explicit Bookkeeping(std::size_t targets) : last_(targets, 0), now_(targets, 0) {}

  void look(const std::vector<Eigen::Vector2d>& truths, const std::vector<core::Track>& tracks,
            ManyTargetsFigures& figures) {
    std::map<std::uint32_t, Eigen::Vector2d> places;
    for (const core::Track& track : tracks) {
      if (track.status != core::TrackStatus::tentative) places[track.id] = track.state.angles();
    }
    std::map<std::uint32_t, Eigen::Vector2d> free = places;
    for (std::size_t i = 0; i < truths.size(); ++i) {
      const auto place = places.find(now_[i]);
      if (place != places.end() && (place->second - truths[i]).norm() > kNear) now_[i] = 0;
      if (place == places.end()) now_[i] = 0;
      if (now_[i] != 0) free.erase(now_[i]);
    }
    assignFree(truths, free, figures);
    figures.looks += static_cast<double>(truths.size());
    for (std::size_t i = 0; i < truths.size(); ++i) {
      if (now_[i] == 0) {
        ++figures.missed;
      } else {
        figures.squares += (places.at(now_[i]) - truths[i]).squaredNorm();
      }
    }
    for (const auto& [id, place] : free) {
      const bool near = std::any_of(
          truths.begin(), truths.end(),
          [place = &place](const Eigen::Vector2d& truth) { return (truth - *place).norm() <= kNear; });
      ++(near ? figures.duplicates : figures.astray);
    }
  }

 private:
  void assignFree(const std::vector<Eigen::Vector2d>& truths, std::map<std::uint32_t, Eigen::Vector2d>& free,
                  ManyTargetsFigures& figures) {
    std::vector<std::size_t> alone;
    for (std::size_t i = 0; i < truths.size(); ++i) {
      if (now_[i] == 0) alone.push_back(i);
    }
    std::vector<std::uint32_t> ids;
    for (const auto& [id, place] : free) ids.push_back(id);
    Eigen::MatrixXd cost(static_cast<Eigen::Index>(alone.size()), static_cast<Eigen::Index>(ids.size()));
    for (Eigen::Index row = 0; row < cost.rows(); ++row) {
      for (Eigen::Index column = 0; column < cost.cols(); ++column) {
        const double distance =
            (free.at(ids[static_cast<std::size_t>(column)]) - truths[alone[static_cast<std::size_t>(row)]])
                .norm();
        cost(row, column) = distance <= kNear ? distance : std::numeric_limits<double>::infinity();
      }
    }
    const std::vector<int> found = core::assign(cost);
    for (std::size_t row = 0; row < alone.size(); ++row) {
      if (found[row] < 0) continue;
      const std::uint32_t id = ids[static_cast<std::size_t>(found[row])];
      now_[alone[row]] = id;
      free.erase(id);
      if (last_[alone[row]] != 0 && last_[alone[row]] != id) ++figures.label_changes;
      last_[alone[row]] = id;
    }
  }

  std::vector<std::uint32_t> last_, now_;
};

}  // namespace

void ManyTargetsFigures::add(const ManyTargetsFigures& other) {
  looks += other.looks;
  missed += other.missed;
  duplicates += other.duplicates;
  astray += other.astray;
  label_changes += other.label_changes;
  local_label_changes += other.local_label_changes;
  squares += other.squares;
  tracker_time += other.tracker_time;
  fusion_time += other.fusion_time;
}

double ManyTargetsFigures::rmse() const {
  return std::sqrt(squares / (2.0 * (looks - missed)));
}

ManyTargetsFigures followMany(const ManyTargets& scene) {
  core::RandomStream random(core::seedOf(scene.seed, "targets"));
  std::vector<Target> targets;
  for (int k = 0; k < scene.targets; ++k) targets.push_back(targetOf(scene, random));

  std::deque<Sensor> sensors;  // never moved: a tracker cannot be copied
  for (int k = 0; k < scene.sensors; ++k) {
    const std::string name = "sensor_" + std::to_string(k + 1);
    core::RandomStream own(core::seedOf(scene.seed, name));
    const double sigma = scene.sigma * (1.0 + k / std::max(scene.sensors - 1.0, 1.0));
    const Eigen::Vector2d bias = scene.bias * sigma * towards(2.0 * M_PI * own.uniform());
    sensors.push_back({name, sigma, bias, own, core::LocalTracker(scene.tracker), core::TrackletBuilder({})});
  }

  ManyTargetsFigures figures, local_figures;
  core::TrackFusion fusion(scene.fusion);
  Bookkeeping bookkeeping(targets.size());
  std::vector<Bookkeeping> local_bookkeeping(sensors.size(), Bookkeeping(targets.size()));
  const double interval = 1.0 / scene.rate;
  for (double round = 1.0; round < 1.0 + scene.duration; round += interval) {
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      Sensor& sensor = sensors[k];
      const double t = round + interval * static_cast<double>(k) / static_cast<double>(sensors.size());
      const core::Scan scan = scanAt(t, scene, targets, sensor);
      const double before = processorTime();
      const core::ScanReport tracked = sensor.tracker.onScan(scan);
      const double between = processorTime();
      if (auto tracklets = sensor.tracklets.onScan(scan, tracked)) {
        tracklets->tracker = sensor.name;
        fusion.onTracklets(*tracklets);
      }
      std::optional<core::FusionReport> fused;
      if (!fusion.take({sensor.name, tracked.time, tracked.tracks}) && fusion.isDue()) fused = fusion.fuse();
      figures.tracker_time += between - before;
      figures.fusion_time += processorTime() - between;
      if (t < 1.0 + kSettled) continue;

      std::vector<Eigen::Vector2d> truths, biased;
      for (const Target& target : targets) {
        truths.push_back(target.at(t));
        biased.push_back(target.at(t) + sensor.bias);
      }
      if (fused) {
        std::vector<core::Track> global;
        for (const core::FusedTrack& track : fused->tracks) global.push_back(track.track);
        bookkeeping.look(truths, global, figures);
      }
      local_bookkeeping[k].look(biased, tracked.tracks, local_figures);
    }
  }
  figures.local_label_changes = local_figures.label_changes;
  return figures;
}

}  // namespace sightline::bench
