#include "fuzz/trial.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <malloc.h>
#include <sstream>

#include <Eigen/Eigenvalues>

#include "sightline/core/model/sphere.h"

#ifdef SIGHTLINE_SANITIZED
extern "C" std::size_t __sanitizer_get_current_allocated_bytes();
#endif

namespace sightline_fuzz {

namespace core = sightline::core;

namespace {

constexpr double kRounding = 1e-9;  // of eigenvalues, in units of standard deviations

double processorTime() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::size_t bytesOnHeap() {
#ifdef SIGHTLINE_SANITIZED
  return __sanitizer_get_current_allocated_bytes();
#else
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
#endif
}

template <typename Matrix>
std::string textOf(const Matrix& matrix) {
  std::ostringstream text;
  text.precision(17);
  text << matrix;
  return text.str();
}

void requireProbability(double value, const std::string& whose) {
  require(std::isnan(value) || (value >= 0.0 && value <= 1.0), whose + " is " + std::to_string(value));
}

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

template <typename Number>
void append(std::string& bytes, Number number) {
  append(bytes, &number, sizeof number);
}

template <typename Matrix>
void appendMatrix(std::string& bytes, const Matrix& matrix) {
  append(bytes, matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
}

void appendTexts(std::string& bytes, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) bytes += text + '\n';
}

}  // namespace

void Trial::call(const std::string& what, const std::function<void()>& call) {
  ++calls_;
  const double before = processorTime();
  try {
    call();
  } catch (const Fault&) {
    throw;
  } catch (const std::exception& problem) {
    throw Fault(what + " threw: " + problem.what());
  }
  const double taken = processorTime() - before;
  longest_ = std::max(longest_, taken);
  require(taken <= limits_.longest_call, what + " took " + std::to_string(taken) + " s of processor time");
  const std::size_t bytes = bytesOnHeap();
  require(bytes <= limits_.most_memory, what + " leaves " + std::to_string(bytes >> 20u) + " MB on the heap");
}

void require(bool holds, const std::string& words) {
  if (!holds) throw Fault(words);
}

void requireCovariance(const Eigen::MatrixXd& covariance, const std::string& whose) {
  const auto complain = [&](const char* what) {
    throw Fault(whose + " " + what + ":\n" + textOf(covariance));
  };
  if (!covariance.allFinite()) complain("is not finite");
  if ((covariance.array() != covariance.transpose().array()).any()) complain("is not symmetric");
  if ((covariance.diagonal().array() < 0.0).any()) complain("has a negative variance");
  Eigen::MatrixXd correlation = covariance;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    const double sigma = std::sqrt(covariance(i, i));
    if (sigma == 0.0 && (covariance.row(i).array() != 0.0).any()) complain("correlates what has no variance");
    if (sigma == 0.0) continue;
    correlation.row(i) /= sigma;
    correlation.col(i) /= sigma;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlation, Eigen::EigenvaluesOnly);
  if (!(eigen.eigenvalues().minCoeff() >= -kRounding)) complain("is not positive semidefinite");
}

void requireSound(const core::Track& track) {
  const std::string whose = "track " + std::to_string(track.id);
  require(track.id != 0, "a track has the id 0");
  require(track.state.mean.allFinite(), whose + ": state is not finite:\n" + textOf(track.state.mean));
  require(std::abs(track.state.mean(0)) <= core::kPi && std::abs(track.state.mean(1)) <= core::kPi / 2.0,
          whose + ": angles are out of range:\n" + textOf(track.state.mean));
  requireCovariance(track.state.covariance, whose + ": covariance");
  require(
      track.gate.centre.allFinite() && track.gate.half_width.allFinite() &&
          (track.gate.half_width.array() >= 0.0).all(),
      whose + ": gate is not finite:\n" + textOf(track.gate.centre) + "\n" + textOf(track.gate.half_width));
  requireCovariance(track.gate.covariance, whose + ": covariance of the gate");
  requireProbability(track.existence, whose + ": existence");
  require(std::is_sorted(track.sources.begin(), track.sources.end()), whose + ": sources are not sorted");
}

void requireSound(const std::vector<core::Track>& tracks) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    requireSound(tracks[i]);
    require(i == 0 || tracks[i - 1].id < tracks[i].id,
            "ids do not ascend: " + std::to_string(i > 0 ? tracks[i - 1].id : 0) + ", " +
                std::to_string(tracks[i].id));
  }
}

void requireSound(const core::FusionReport& report) {
  for (std::size_t i = 0; i < report.tracks.size(); ++i) {
    const core::FusedTrack& fused = report.tracks[i];
    require(i == 0 || report.tracks[i - 1].track.id < fused.track.id, "ids of global tracks do not ascend");
    if (fused.withheld) continue;
    requireSound(fused.track);
    const std::string whose = "global track " + std::to_string(fused.track.id);
    double sum = 0.0;
    for (const core::SourceTrack& source : fused.sources) {
      require(source.weight >= 0.0 && source.weight <= 1.0 + kRounding,
              whose + ": weight of " + source.tracker + " is " + std::to_string(source.weight));
      require(!(source.distance_squared < 0.0) && !std::isinf(source.distance_squared) &&
                  std::isfinite(source.age),
              whose + ": distance or age of a source");
      sum += source.weight;
    }
    require(fused.sources.empty() || std::abs(sum - 1.0) < 1e-6,
            whose + ": weights sum to " + std::to_string(sum));
    for (const core::SourceTrack& source : fused.left_out)
      require(source.weight == 0.0 && source.reason, whose + ": left out with a weight or without a reason");
  }
  for (const core::SourceTrack& source : report.left_out)
    require(source.reason.has_value(), "a local track is left out without a reason");
}

void requireSound(const core::PositionOutput& output) {
  const auto& tracks = output.tracks.tracks;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const core::PositionTrack& track = tracks[i];
    const std::string whose = "position " + std::to_string(track.id);
    require(track.id != 0 && (i == 0 || tracks[i - 1].id < track.id), "ids of positions do not ascend");
    require(track.position.allFinite() && track.velocity.allFinite(), whose + " is not finite");
    requireCovariance(track.covariance, whose + ": covariance");
    requireProbability(track.existence, whose + ": existence");
    require(track.parallax >= 0.0 && track.parallax <= core::kPi + kRounding, whose + ": parallax");
  }
  for (const auto& refused : output.report.refused)
    require(refused.position.allFinite() && !std::isnan(refused.score), "a refused crossing is not finite");
  for (const auto& station : output.report.stations)
    require(station.slow_scale >= 0.0 && std::isfinite(station.slow_scale) && station.time_constant > 0.0 &&
                std::isfinite(station.time_constant),
            "what is learnt of " + station.tracker + " is not finite");
}

std::string bytesOf(const std::vector<core::Track>& tracks) {
  std::string bytes;
  for (const core::Track& track : tracks) {
    append(bytes, track.id);
    append(bytes, track.status);
    appendMatrix(bytes, track.state.mean);
    appendMatrix(bytes, track.state.covariance);
    appendMatrix(bytes, track.gate.centre);
    appendMatrix(bytes, track.gate.half_width);
    appendMatrix(bytes, track.gate.covariance);
    append(bytes, track.last_sighting.time_since_epoch().count());
    append(bytes, track.hits);
    append(bytes, track.misses);
    append(bytes, track.existence);
    appendTexts(bytes, track.sources);
  }
  return bytes;
}

std::string bytesOf(const core::PositionOutput& output) {
  std::string bytes;
  for (const core::PositionTrack& track : output.tracks.tracks) {
    append(bytes, track.id);
    append(bytes, track.status);
    appendMatrix(bytes, track.position);
    appendMatrix(bytes, track.velocity);
    appendMatrix(bytes, track.covariance);
    append(bytes, track.last_sighting.time_since_epoch().count());
    append(bytes, track.parallax);
    appendTexts(bytes, track.sources);
  }
  return bytes;
}

}  // namespace sightline_fuzz
