// Every estimator with its default settings on recorded sightings of one target, sensor by sensor, in a
// closed loop.
//
//   recordings FILE.csv ...     columns time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation (s, rad)
//
// A recording is split at pauses over 1 s; of each sensor the first six stretches of at least 40 sightings
// count. A sighting within the gate (99.95 %) updates; eight outside it in turn, or one second without, start
// anew. NIS: squared innovation over what the estimator expected, a channel, 1 when consistent (a stated
// sigma that is too large makes it small). Half a second ahead: angle between the predicted state and the
// sighting then, root mean square of a channel, and median of both.

#include "recordings.h"

#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/sphere.h"

#include "quantiles.h"

namespace sightline::bench {
namespace {

std::vector<std::pair<const char*, core::EstimatorParams>> estimators() {
  using core::EstimatorForm;
  using core::EstimatorKind;
  core::EstimatorParams twbls, twbls_paper, noga, noga_paper, kalman, imm;
  twbls.kind = twbls_paper.kind = EstimatorKind::twbls;
  noga.kind = noga_paper.kind = EstimatorKind::noga;
  kalman.kind = EstimatorKind::kalman;
  imm.kind = EstimatorKind::imm;
  twbls.twbls_form = noga.noga_form = EstimatorForm::consistent;
  twbls_paper.twbls_form = noga_paper.noga_form = EstimatorForm::paper;
  return {{"twbls paper", twbls_paper}, {"twbls", twbls}, {"noga paper", noga_paper}, {"noga", noga},
          {"kalman", kalman},           {"imm", imm}};
}

void printRecording(const std::string& file) {
  std::map<std::string, std::vector<Stretch>> of_sensor;
  for (Stretch& stretch : readStretches(file)) {
    auto& stretches = of_sensor[stretch.sensor];
    if (stretches.size() < 6) stretches.push_back(std::move(stretch));
  }
  std::printf("\n%s\n%-12s %-12s %9s %9s %8s %7s %11s %8s\n", file.c_str(), "sensor", "", "sightings",
              "accepted", "restarts", "NIS", "0.5 s ahead", "median");
  for (const auto& [sensor, stretches] : of_sensor) {
    for (const auto& entry : estimators()) {
      const auto make = [&] { return core::makeEstimator(entry.second); };
      RecordingFigures figures;
      for (const Stretch& stretch : stretches) follow(stretch, make, figures);
      std::printf("%-12s %-12s %9d %7.1f %% %8d %7.2f %7.3f deg %4.3f deg\n", sensor.c_str(), entry.first,
                  figures.sightings, 100.0 * figures.accepted / figures.sightings, figures.restarts,
                  figures.nis(), figures.aheadRms() / core::kDegree, median(figures.ahead) / core::kDegree);
    }
  }
}

}  // namespace
}  // namespace sightline::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: recordings FILE.csv ...\n");
    return 2;
  }
  try {
    for (int i = 1; i < argc; ++i) sightline::bench::printRecording(argv[i]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "recordings: %s\n", error.what());
    return 1;
  }
  return 0;
}
