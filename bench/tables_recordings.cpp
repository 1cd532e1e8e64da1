// Recorded sightings, section 8: the position predicted half a second ahead, against the best of twenty
// single filters chosen for each sensor in hindsight.
//
// A recording is split at pauses over 1 s; of each sensor the first six stretches of at least 40 sightings
// count. Every sighting is shown to every contender. The filters: white acceleration and white jerk of
// 1e-2 ... 1e7 times the stated variance. The error is the angle between the predicted direction and the
// sighting nearest to 0.5 s later, within 30 ms, from the second sighting of a stretch on; root mean square
// of a channel. (Section 8 has raw azimuths and does not say where it starts to count: its figures, beside
// ours, are of the same size only.) NIS: squared innovation over what was expected (P and the noise as the
// contender found it), a channel, after the first 2 s of a stretch. Bands over blocks of 2 s.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "sightline/core/estimators/estimators.h"

#include "monte_carlo.h"
#include "parallel.h"
#include "recorded_targets.h"
#include "recordings.h"
#include "tables.h"

namespace sightline::bench {
namespace {

constexpr double kAhead = 0.5, kNearby = 0.03, kSettled = 2.0, kBlock = 2.0;  // [s]

struct Outcome {
  std::string name;
  Sample squares;  // sum of squared angles of each block [rad^2]
  int predictions = 0;
  double nis = 0.0, noise_scale = 1.0;

  double rms() const {
    const double sum = squares.mean() * static_cast<double>(squares.values().size());
    return std::sqrt(sum / (2.0 * predictions));
  }
};

/// Index of the sighting nearest to `time`, or none within kNearby.
std::optional<std::size_t> nearest(const Stretch& stretch, core::Time time) {
  const auto after = std::lower_bound(stretch.times.begin(), stretch.times.end(), time);
  std::optional<std::size_t> best;
  double smallest = kNearby;
  for (const auto place : {after == stretch.times.begin() ? after : after - 1, after}) {
    if (place == stretch.times.end()) continue;
    const double miss = std::abs(core::seconds(*place - time));
    if (miss <= smallest) smallest = miss, best = static_cast<std::size_t>(place - stretch.times.begin());
  }
  return best;
}

/// A contender's way through one stretch.
class Follower {
 public:
  Follower(const Contender& contender, const Stretch& stretch)
      : stretch_(stretch),
        estimator_(contender.make()),
        chart_(core::Chart::around(stretch.sightings.front().direction)) {}

  void run(std::vector<double>& blocks, Outcome& outcome, double& sum_nis, int& innovations) {
    const core::Time start = stretch_.times.front();
    const std::size_t first_block = blocks.size();
    for (std::size_t i = 0; i < stretch_.times.size(); ++i) {
      const core::Time time = stretch_.times[i];
      const core::Measurement measurement = measured(i);
      if (const auto state = estimator_->stateAt(time); state && core::seconds(time - start) > kSettled) {
        const Eigen::Matrix2d S = state->anglesCovariance() +
                                  core::noiseCovariance(measurement.covariance, estimator_->noiseScale());
        const Eigen::Vector2d innovation = core::angleDifference(measurement.position, state->angles());
        sum_nis += innovation.dot(S.llt().solve(innovation)) / 2.0;
        ++innovations;
      }
      estimator_->update(measurement);
      const auto target = nearest(stretch_, time + core::durationOf(kAhead));
      if (i == 0 || !target || *target == i) continue;  // one sighting tells no motion
      const auto ahead = estimator_->stateAt(stretch_.times[*target]);
      const double angle =
          core::angleBetween(chart_.directionAt(ahead->angles()), stretch_.sightings[*target].direction);
      const auto block = first_block + static_cast<std::size_t>(core::seconds(time - start) / kBlock);
      if (blocks.size() <= block) blocks.resize(block + 1, 0.0);
      blocks[block] += angle * angle;
      ++outcome.predictions;
    }
    outcome.noise_scale = estimator_->noiseScale().mean();
  }

 private:
  /// The sighting in the chart, after the chart has moved along if the target has left it.
  core::Measurement measured(std::size_t i) {
    if (const auto state = estimator_->stateAt(stretch_.times[i]); state && !chart_.holds(state->angles())) {
      const core::Chart next = core::Chart::around(chart_.directionAt(state->angles()));
      estimator_->rotate(next.R_chart_tracking() * chart_.R_chart_tracking().transpose());
      chart_ = next;
    }
    core::Measurement measurement;
    measurement.time = stretch_.times[i];
    measurement.position = chart_.coordinatesOf(stretch_.sightings[i].direction);
    measurement.covariance = chart_.covarianceOf(stretch_.sightings[i]);
    return measurement;
  }

  const Stretch& stretch_;
  std::unique_ptr<core::Estimator> estimator_;
  core::Chart chart_;
};

Outcome follow(const Contender& contender, const std::vector<Stretch>& stretches) {
  Outcome outcome;
  outcome.name = contender.name;
  std::vector<double> blocks;
  double sum_nis = 0.0;
  int innovations = 0;
  for (const Stretch& stretch : stretches)
    Follower(contender, stretch).run(blocks, outcome, sum_nis, innovations);
  outcome.squares = Sample(std::move(blocks));
  outcome.nis = sum_nis / innovations;
  return outcome;
}

std::vector<Contender> singleFilters() {
  const double all = std::numeric_limits<double>::infinity();
  std::vector<Contender> filters;
  for (int exponent = -2; exponent <= 7; ++exponent) {
    core::EstimatorParams acceleration, jerk;
    acceleration.kind = core::EstimatorKind::kalman;
    acceleration.kalman.process_noise_ratio = std::pow(10.0, exponent);
    acceleration.kalman.initial_rate_sigma = 0.5;
    jerk.kind = core::EstimatorKind::imm;
    jerk.imm.models = {{2, {0.0, std::pow(10.0, exponent)}}};
    jerk.imm.initial_rate_sigma = jerk.imm.initial_acceleration_sigma = 0.5;
    const std::string power = "1e" + std::to_string(exponent);
    filters.push_back({"acc " + power, [acceleration] { return core::makeEstimator(acceleration); }, all});
    filters.push_back({"jerk " + power, [jerk] { return core::makeEstimator(jerk); }, all});
  }
  return filters;
}

std::vector<Contender> contenders() {
  std::vector<Contender> all = ours(std::numeric_limits<double>::infinity());
  core::EstimatorParams imm, kalman;
  imm.kind = core::EstimatorKind::imm;
  kalman.kind = core::EstimatorKind::kalman;
  all.push_back({"IMM", [imm] { return core::makeEstimator(imm); }, all.front().gate});
  all.push_back({"Kalman", [kalman] { return core::makeEstimator(kalman); }, all.front().gate});
  return all;
}

struct Line {
  Recorded recorded;
  std::vector<Outcome> contenders;
  Outcome best;
};

Line measured(const Recorded& recorded, const Options& options) {
  const std::vector<Contender> filters = singleFilters();
  std::vector<Contender> all = contenders();
  const std::size_t count = all.size();
  all.insert(all.end(), filters.begin(), filters.end());
  std::vector<Outcome> outcomes(all.size());
  forEachRun(static_cast<int>(all.size()), options.threads, [&](int k) {
    outcomes[static_cast<std::size_t>(k)] = follow(all[static_cast<std::size_t>(k)], recorded.stretches);
  });
  Line line;
  line.recorded = recorded;
  line.contenders.assign(outcomes.begin(), outcomes.begin() + static_cast<std::ptrdiff_t>(count));
  line.best = outcomes[count];
  for (std::size_t k = count; k < outcomes.size(); ++k)
    if (outcomes[k].rms() < line.best.rms()) line.best = outcomes[k];
  return line;
}

void printLine(const Line& line) {
  std::printf("%-19s|%7.3f %-8s", line.recorded.name.c_str(), line.best.rms() / sightline::core::kDegree,
              line.best.name.c_str());
  if (line.recorded.in_section_8) {
    std::printf("%6.3f ", line.recorded.reference_best);
  } else {
    std::printf("%6s ", "-");
  }
  for (std::size_t k = 0; k < line.contenders.size(); ++k) {
    const Outcome& outcome = line.contenders[k];
    const Ratio ratio = rootRatio(outcome.squares, line.best.squares);
    std::printf("|%7.3f %5.2f +-%4.2f", outcome.rms() / sightline::core::kDegree, ratio.value,
                ratio.log_band * ratio.value);
    if (k < 2) std::printf(" %5.2f %5.2f", outcome.nis, std::sqrt(outcome.noise_scale));
  }
  std::printf("\n");
}

void printMeans(const std::vector<Line>& lines, bool in_section_8) {
  for (std::size_t k = 0; k < lines.front().contenders.size(); ++k) {
    std::vector<Ratio> ratios;
    Ratio worst;
    double least_nis = 1e9, largest_nis = 0.0;
    for (const Line& line : lines) {
      if (line.recorded.in_section_8 != in_section_8) continue;
      const Outcome& outcome = line.contenders[k];
      ratios.push_back(rootRatio(outcome.squares, line.best.squares));
      if (ratios.back().value > worst.value) worst = ratios.back();
      least_nis = std::min(least_nis, outcome.nis), largest_nis = std::max(largest_nis, outcome.nis);
    }
    const Ratio mean = geometricMean(ratios);
    const double band = mean.log_band * mean.value;
    std::printf("  %-7s geometric mean %.3f +-%.3f", lines.front().contenders[k].name.c_str(), mean.value,
                band);
    if (k < 2) {
      std::printf(" <= 1.00 %s, then 0.95 %s", markOf(mean.value, 1.0, band), markOf(mean.value, 0.95, band));
      std::printf("; worst %.2f <= 1.15 %s", worst.value,
                  markOf(worst.value, 1.15, worst.log_band * worst.value));
      const bool low = markOf(least_nis, 0.7, 1.4, 0.0)[0] == 'm', high = largest_nis <= 1.4;
      std::printf("; NIS %.2f to %.2f in [0.7, 1.4] %s", least_nis, largest_nis,
                  low && high ? "met" : "MISSED");
    }
    std::printf("\n");
  }
}

}  // namespace

void printRecordings(const Options& options) {
  std::printf(
      "\n## Recordings: position predicted 0.5 s ahead, degrees rms of a channel, over the best of 20 single "
      "filters in hindsight\n");
  if (options.recordings.empty() || !std::filesystem::is_directory(options.recordings)) {
    std::printf("skipped: there are no recordings in \"%s\"; name their folder with --recordings DIR\n",
                options.recordings.c_str());
    return;
  }
  std::vector<Line> lines;
  for (const Recorded& recorded : recordedTargets(options.recordings))
    lines.push_back(measured(recorded, options));
  std::printf("%-19s|%-15s %-7s", "", "  best single", "sec. 8");
  for (std::size_t k = 0; k < lines.front().contenders.size(); ++k) {
    const std::string& name = lines.front().contenders[k].name;
    std::printf("|%-7s  ratio      %s", name.c_str(), k < 2 ? "   NIS scale" : "");
  }
  std::printf("\n");
  for (const Line& line : lines) printLine(line);
  std::printf("the seven of section 8:\n");
  printMeans(lines, true);
  std::printf("not named there (drone, thermal clips, harbour, crossing):\n");
  printMeans(lines, false);
}

}  // namespace sightline::bench
