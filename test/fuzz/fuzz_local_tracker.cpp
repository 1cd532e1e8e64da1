#include <algorithm>
#include <optional>

#include "sightline/core/model/usable_sighting.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"

#include "fuzz/fuzz_targets.h"
#include "fuzz/random_params.h"
#include "fuzz/random_scans.h"

namespace sightline_fuzz {

namespace core = sightline::core;

namespace {

void requireSoundReport(const core::ScanReport& report, const core::Scan& scan) {
  sightline_fuzz::requireSound(report.tracks);
  require(report.associations.size() == scan.sightings.size(), "not one association for each sighting");
  for (std::size_t j = 0; j < report.associations.size(); ++j) {
    const core::Association& association = report.associations[j];
    require(association.sighting == j, "associations are not in the order of the sightings");
    require((association.decision == core::Decision::rejected_input) == !association.reason.empty(),
            "a rejected sighting has no reason, or another has one");
    if (report.refusal)
      require(association.decision == core::Decision::rejected_input, "a refused scan's sighting is used");
  }
  require(report.use.noise_scale > 0.0, "the noise scale of a scan is not positive");
}

void requireSoundTracklets(const core::TrackletReport& report) {
  for (const core::TrackTracklet& entry : report.tracklets) {
    const core::Sighting& sighting = entry.tracklet.sighting;
    require(entry.track != 0 && !entry.tracklet.sensor.empty(), "a tracklet of no track or sensor");
    std::ostringstream what;
    what.precision(17);
    what << "a tracklet that cannot be used: " << sighting.direction.transpose() << "; "
         << sighting.covariance;
    require(core::isUsable(sighting), what.str());
    require(entry.tracklet.sightings > 0.0, "a tracklet of no sightings");
  }
}

}  // namespace

void fuzzLocalTracker(RandomInput& input, Trial& trial) {
  const core::LocalTrackerParams params = randomTracker(input);
  core::LocalTracker tracker(params);
  core::TrackletParams compression;
  compression.interval = input.oneOf({0.0, 0.1, 1.0});
  compression.compression.span = input.oneOf({0.15, 0.0, 3.0});
  compression.compression.nodes = input.between(1, core::kMostNodes);
  core::TrackletBuilder builder(compression);
  RandomScans scans(input, randomHazards(input));
  for (int n = input.oneOf({10, 60, 60, 250}); n > 0; --n) {
    const core::Scan scan = scans.next();
    trial.call("LocalTracker::onScan", [&] {
      const core::ScanReport report = tracker.onScan(scan);
      requireSoundReport(report, scan);
      if (const auto tracklets = builder.onScan(scan, report)) requireSoundTracklets(*tracklets);
    });
    if (input.chance(0.01)) tracker.startAnew(scan.time);
  }
}

/// No scan is too late, and none is given twice: then the order of arrival must not matter.
void fuzzArrivalOrder(RandomInput& input, Trial& trial) {
  core::LocalTrackerParams params = randomTracker(input);
  params.max_lag = std::max(params.max_lag, 1e-3);
  Hazards hazards = randomHazards(input);
  hazards.times = 0.0;
  RandomScans source(input, hazards);
  std::vector<core::Scan> scans;
  for (int n = input.oneOf({10, 60, 150}); n > 0; --n) scans.push_back(source.next());
  std::stable_sort(scans.begin(), scans.end(),
                   [](const core::Scan& a, const core::Scan& b) { return core::precedes(a, b); });
  // What has the same place in the order is one exposure for the tracker: it uses what comes first.
  scans.erase(std::unique(scans.begin(), scans.end(),
                          [](const core::Scan& a, const core::Scan& b) { return !core::precedes(a, b); }),
              scans.end());

  struct Arrival {
    core::Time time;
    std::size_t scan;
  };
  std::vector<Arrival> arrivals;
  const double lag = 0.98 * params.max_lag * input.oneOf({1.0, 0.1, 0.001});
  for (std::size_t k = 0; k < scans.size(); ++k)
    arrivals.push_back({scans[k].time + core::durationOf(lag * input.unit()), k});
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const Arrival& a, const Arrival& b) { return a.time < b.time; });

  core::LocalTracker in_order(params), as_they_come(params);
  std::vector<core::Track> expected, got;
  for (const core::Scan& scan : scans)
    trial.call("LocalTracker::onScan in order", [&] { expected = in_order.onScan(scan).tracks; });
  for (const Arrival& arrival : arrivals) {
    trial.call("LocalTracker::onScan out of order", [&] {
      const core::ScanReport report = as_they_come.onScan(scans[arrival.scan]);
      requireSoundReport(report, scans[arrival.scan]);
      got = report.tracks;
    });
  }
  require(bytesOf(expected) == bytesOf(got), "tracks depend on the order in which scans arrive");
}

}  // namespace sightline_fuzz
