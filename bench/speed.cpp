// Time per sighting of every estimator in the core, and of a whole local tracker, on the paper's benchmark;
// allocations per sighting after warm-up. One line each: the median over repetitions of 10^5 sightings.
//
//   speed [Google Benchmark's options]

#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include <benchmark/benchmark.h>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/tracking/local_tracker.h"

#include "paper_benchmark.h"

namespace {
std::atomic<std::size_t> allocations{0};
}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto boundary = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(boundary, (size + boundary - 1) / boundary * boundary)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace sightline::bench {
namespace {

using namespace core;

constexpr double kSigma = 0.08;
constexpr std::size_t kWarmUp = 1000;
constexpr int kSightings = 100000;

const std::vector<Measurement>& stream() {
  static const std::vector<Measurement> sightings =
      simulate(1, kSigma, 0.031 * (kSightings + 2.0 * kWarmUp)).sightings;
  return sightings;
}

/// One sighting is one prediction to its time and one update with both channels.
void estimatorSpeed(benchmark::State& state, const EstimatorParams& params) {
  const auto estimator = makeEstimator(params);
  std::size_t next = 0;
  while (next < kWarmUp) estimator->update(stream()[next++]);
  const std::size_t before = allocations;
  for (auto _ : state) {
    const Measurement& sighting = stream()[next++];
    benchmark::DoNotOptimize(estimator->stateAt(sighting.time));
    estimator->update(sighting);
  }
  state.counters["allocations"] =
      static_cast<double>(allocations - before) / static_cast<double>(state.iterations());
}

/// One scan of one sighting through prediction, gate, association, update, lifecycle, report and memory for
/// late scans.
void trackerSpeed(benchmark::State& state, const EstimatorParams& params) {
  LocalTrackerParams tracker_params;
  tracker_params.estimator = params;
  LocalTracker tracker(tracker_params);
  std::vector<Scan> scans;
  for (const Measurement& sighting : stream()) {
    Scan scan;
    scan.time = sighting.time;
    scan.sensor = "camera";
    scan.sightings.push_back(sightingOf(sighting.position, sighting.covariance));
    scans.push_back(std::move(scan));
  }
  std::size_t next = 0;
  while (next < kWarmUp) tracker.onScan(scans[next++]);
  for (auto _ : state) benchmark::DoNotOptimize(tracker.onScan(scans[next++]));
}

}  // namespace
}  // namespace sightline::bench

int main(int argc, char** argv) {
  using namespace sightline::bench;
  using sightline::core::EstimatorForm;
  using sightline::core::EstimatorKind;
  sightline::core::EstimatorParams twbls, twbls_consistent, noga, noga_consistent, kalman, imm;
  twbls.kind = twbls_consistent.kind = EstimatorKind::twbls;
  twbls.twbls_form = EstimatorForm::paper;
  twbls.twbls.max_sightings = 20;
  noga.kind = noga_consistent.kind = EstimatorKind::noga;
  noga.noga_form = EstimatorForm::paper;
  kalman.kind = EstimatorKind::kalman;
  imm.kind = EstimatorKind::imm;
  const std::vector<std::pair<const char*, sightline::core::EstimatorParams>> estimators{
      {"twbls_paper_20", twbls},
      {"noga_paper_18", noga},
      {"twbls_consistent_60", twbls_consistent},
      {"noga_consistent", noga_consistent},
      {"kalman", kalman},
      {"imm", imm}};
  for (const auto& [name, params] : estimators) {
    benchmark::RegisterBenchmark((std::string("estimator/") + name).c_str(), estimatorSpeed, params)
        ->Iterations(kSightings)
        ->Repetitions(9)
        ->ReportAggregatesOnly();
    benchmark::RegisterBenchmark((std::string("tracker/") + name).c_str(), trackerSpeed, params)
        ->Iterations(kSightings)
        ->Repetitions(5)
        ->ReportAggregatesOnly();
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
