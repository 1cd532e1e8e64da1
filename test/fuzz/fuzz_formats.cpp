#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "sightline/core/model/sighting.h"
#include "sightline/formats/formats.h"
#include "sightline/report/csv_table.h"

#include "fuzz/fuzz_targets.h"
#include "fuzz/text_mutations.h"
#include "support/paths.h"

namespace sightline_fuzz {

namespace core = sightline::core;
namespace formats = sightline::formats;
namespace report = sightline::report;

namespace {

const std::vector<std::string>& samples() {
  static const std::vector<std::string> texts = [] {
    std::vector<std::string> read;
    for (const char* name :
         {"cmn_apo.txt", "dfn_small_36.ecsv", "gfe.ecsv", "iod.txt", "krakensdr.csv", "mot_det.txt",
          "mot_gt.txt", "odas_potential.json", "odas_tracked.json", "rms.txt", "tdm_azel.txt", "tdm_azel.xml",
          "tdm_xsye.txt", "tdm_xsye.xml", "uk.txt"})
      read.push_back(
          formats::TextFile::fromFile(sightline::test::sourceDirectory() + "/test/formats/data/" + name)
              .text());
    read.emplace_back(
        "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation,scan,target\n"
        "1700000000.000,a,0.1,0.2,0.001,0.001,1,x\n1700000000.033,a,0.101,0.2,0.001,0.001,2,x\n"
        "1700000000.066,a,,,,,3,\n");
    read.emplace_back("t;Az [deg];El [deg];id\n0,1;12,5;3,0;7\n0,2;12,6;3,1;7\n");
    return read;
  }();
  return texts;
}

formats::ImportOptions randomOptions(RandomInput& input) {
  formats::ImportOptions options;
  const auto& known = formats::formats();
  if (input.chance(0.15))
    options.format =
        known[static_cast<std::size_t>(input.between(0, static_cast<int>(known.size()) - 1))].name;
  if (input.chance(0.7)) options.sensor = input.oneOf<const char*>({"camera", "", "a b/c"});
  if (input.chance(0.8)) options.sigma = Eigen::Vector2d(1e-3, 2e-3);
  if (input.chance(0.3)) options.sigma_pixels = input.oneOf({0.5, 1e-9, 1e9});
  if (input.chance(0.5)) options.elevation = input.oneOf({0.0, 0.3, 1.57});
  if (input.chance(0.5)) options.heading = input.oneOf({0.0, 2.0, -7.0});
  if (input.chance(0.6)) options.stations[""] = {-30.0, 120.0, 200.0};
  if (input.chance(0.2))
    options.columns =
        input.oneOf<const char*>({"time=t,azimuth=Az [deg]:deg,elevation=El [deg]:deg", "time=1,azimuth=2",
                                  "time=t:ms,azimuth=nothing", "", "a=b=c", ",", "time"});
  if (input.chance(0.1)) options.separator = input.oneOf({';', ',', '\t', ' ', '0'});
  if (input.chance(0.2)) options.decimal_comma = input.chance(0.5);
  if (input.chance(0.3))
    options.camera = sightline::test::sourceDirectory() + "/test/formats/data/camera.yaml";
  if (input.chance(0.5)) {
    options.field_of_view = Eigen::Vector2d(1.0, 0.7);
    options.image_size = Eigen::Vector2d(1920.0, 1080.0);
  }
  if (input.chance(0.6)) options.frame_rate = input.oneOf({25.0, 1e-9, 1e9});
  if (input.chance(0.2)) options.least_confidence = input.oneOf({0.5, -1.0, 1e9});
  if (input.chance(0.2)) options.ut1_minus_utc = input.oneOf({0.1, -0.9});
  if (input.chance(0.2)) options.offset = core::durationOf(input.oneOf({-1.0, 3600.0, 1e9, -4e9}));
  options.for_truth = input.chance(0.2);
  return options;
}

void requireSoundRecording(const formats::Recording& recording, bool is_truth) {
  for (std::size_t k = 0; k < recording.scans.size(); ++k) {
    const formats::FileScan& scan = recording.scans[k];
    require(k == 0 || recording.scans[k - 1].time <= scan.time, "scans of a file are not in order of time");
    require(!scan.sensor.empty(), "a scan of a file has no sensor");
    for (const formats::FileSighting& sighting : scan.sightings) {
      require(sighting.angles.allFinite(), "a direction of a file is not finite");
      if (is_truth) continue;
      const Eigen::Matrix2d covariance = sighting.sigma.cwiseAbs2().asDiagonal();
      const auto refusal = core::rejectionOf(sighting.angles, covariance);
      require(!refusal, "a sighting that trackers reject: " + (refusal ? refusal->detail : ""));
    }
  }
}

}  // namespace

void fuzzFormats(RandomInput& input, Trial& trial) {
  const auto& known = samples();
  for (int n = 8; n > 0; --n) {
    const std::string& sample =
        known[static_cast<std::size_t>(input.between(0, static_cast<int>(known.size()) - 1))];
    const formats::ImportOptions options = randomOptions(input);
    const std::string text = mutated(input, sample);
    trial.callThatRefuses<formats::FormatError>("readRecording", [&] {
      const formats::Recording recording = formats::readRecording(formats::TextFile("file", text), options);
      requireSoundRecording(recording, options.for_truth);
      formats::truthCsv(recording);
    });
  }
}

void fuzzCsvTables(RandomInput& input, Trial& trial) {
  const std::string sample =
      "time,target,azimuth,elevation\n0.0,1,0.1,0.2\n1700000000.123456789,2,-3.1,1.5\n0.2,3,1e-9,-0\n\n0.3,4,"
      "0,0\n";
  for (int n = 20; n > 0; --n) {
    std::istringstream stream(mutated(input, sample));
    trial.callThatRefuses<report::CsvError>("CsvTable", [&] {
      const report::CsvTable table(stream, "file", {"time", "azimuth", "elevation"}, {"target"});
      for (std::size_t row = 0; row < table.rows(); ++row) {
        table.time(row, "time");
        require(std::isfinite(table.number(row, "azimuth", "rad")), "a number of a CSV file is not finite");
        if (table.has("target")) table.text(row, "target");
      }
    });
  }
}

}  // namespace sightline_fuzz
