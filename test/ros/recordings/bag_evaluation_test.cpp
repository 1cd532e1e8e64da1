// `evaluate` on small bags whose errors are known.
#include "sightline/ros/recordings/bag_evaluation.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include <rosbag/bag.h>
#include <sightline/AssociationArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>

#include "sightline/ros/recordings/recorded_truth.h"

#include "support/paths.h"
#include "support/scratch_folder.h"

using namespace sightline_ros;

namespace {

constexpr double kBagStart = 100.0, kStep = 0.05;  // [s]
constexpr int kInstants = 101;

Eigen::Vector4d truthAt(double t) {
  return {0.3 + 0.2 * std::sin(t), 0.0, 0.2 * std::cos(t), 0.0};
}

sightline::Track track(std::uint32_t id, const Eigen::Vector4d& mean, double sigma,
                       const std::string& source) {
  sightline::Track message;
  message.id = id;
  message.status = sightline::Track::CONFIRMED;
  message.azimuth = mean(0);
  message.elevation = mean(1);
  message.azimuth_rate = mean(2);
  message.elevation_rate = mean(3);
  message.covariance.fill(0.0);
  for (int i = 0; i < 4; ++i) message.covariance[5 * i] = sigma * sigma;
  message.sources = {source};
  return message;
}

sightline::Sighting sighting(const Eigen::Vector2d& angles, double sigma) {
  sightline::Sighting message;
  message.azimuth = angles.x();
  message.elevation = angles.y();
  message.covariance = {sigma * sigma, 0.0, 0.0, sigma * sigma};
  message.snr = std::nan("");
  return message;
}

/// A recording of one sensor, its tracker and a fusion, with errors that are the same at every instant. From
/// instant `lost` to `found` there is no track; after it, another one.
struct RecordingOptions {
  int lost = kInstants, found = kInstants;
  bool with_truth = true;
};

std::string makeBag(const ScratchFolder& folder, const RecordingOptions& options = {}) {
  const std::string path = folder.file("run.bag");
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  for (int i = 0; i < kInstants; ++i) {
    const double t = kStep * i;
    const ros::Time stamp(kBagStart + t);
    const Eigen::Vector4d truth = truthAt(t);

    sightline::SightingArray scan;
    scan.header.stamp = stamp;
    scan.header.frame_id = "platform_enu";
    scan.sensor = "cam";
    scan.ifov = scan.detection_probability = scan.clutter_density = std::nan("");
    scan.sightings = {sighting(truth.head<2>() + Eigen::Vector2d(0.006, 0.008), 0.01),
                      sighting({-2.0, 0.0}, 0.01)};
    bag.write("/sensors/cam/sightings", stamp, scan);

    sightline::TrackArray tracks;
    tracks.header = scan.header;
    tracks.tracker = "cam";
    tracks.estimator = "twbls";
    const bool has_track = i < options.lost || i >= options.found;
    if (has_track) {
      tracks.tracks = {
          track(i < options.lost ? 1 : 2, truth + Eigen::Vector4d(0.003, 0.004, 0.0, 0.0), 0.005, "cam")};
    }
    bag.write("/sensors/cam/tracks", stamp, tracks);
    tracks.tracker = "fusion";
    tracks.estimator = "weighted_covariance";
    tracks.tracks = {track(1, truth + Eigen::Vector4d(0.001, 0.0, 0.0, 0.0), 0.001, "cam")};
    bag.write("/fusion/tracks", stamp, tracks);

    sightline::AssociationArray associations;
    associations.header = scan.header;
    associations.associations.resize(2);
    associations.associations[0].decision = sightline::Association::ACCEPTED;
    associations.associations[0].distance_squared = i % 2 == 0 ? 1.0 : 2.0;
    associations.associations[1].decision = sightline::Association::OUTSIDE_GATE;
    bag.write("/sensors/cam/associations", stamp, associations);

    if (options.with_truth) {
      tracks.tracker = tracks.estimator = "truth";
      tracks.tracks = {track(1, truth, 0.0, "")};
      bag.write("/truth", stamp, tracks);
    }
  }
  return path;
}

/// Words of the first line that begins with `first` in the part of the report from `section` on.
std::vector<std::string> wordsAfter(const std::string& report, const std::string& section,
                                    const std::string& first) {
  std::istringstream stream(report.substr(std::min(report.find(section), report.size())));
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::vector<std::string> all{std::istream_iterator<std::string>(words), {}};
    if (!all.empty() && all.front() == first) return all;
  }
  ADD_FAILURE() << "no line of " << first << " after \"" << section << "\" in\n" << report;
  return std::vector<std::string>(20);
}

BagEvaluationSettings withTruth(const std::string& truth) {
  BagEvaluationSettings settings;
  settings.truth = truth;
  return settings;
}

TEST(BagEvaluation, FindsTheErrorsThatWereMade) {
  const ScratchFolder folder;
  const std::string report = evaluateBag(makeBag(folder), withTruth("/truth"));
  const auto sightings = wordsAfter(report, "sightings", "/sensors/cam/sightings");
  EXPECT_EQ(sightings[1], "101");
  EXPECT_EQ(sightings[2], "0.007071");  // 0.01 / sqrt(2)
  EXPECT_EQ(sightings[3], "0.707");
  EXPECT_EQ(sightings.back(), "101");  // the false ones
  const auto tracks = wordsAfter(report, "local tracks", "/sensors/cam/tracks");
  EXPECT_EQ(tracks[2], "0.003536");  // 0.005 / sqrt(2)
  EXPECT_EQ(tracks[3], "0.354");
  EXPECT_EQ(tracks[5], "0.50");
  EXPECT_EQ(tracks[6], "[0.81,");  // 202 degrees of freedom
  const auto fused = wordsAfter(report, "fused tracks", "/fusion/tracks");
  EXPECT_EQ(fused[2], "0.0007071");
  const auto gospa = wordsAfter(report, "GOSPA", "/sensors/cam/tracks");
  EXPECT_EQ(gospa[1], "101");
  EXPECT_EQ(gospa[2], "0.005");
  EXPECT_EQ(gospa[4], "0.0000");
  const auto associations = wordsAfter(report, "associations", "/sensors/cam/associations");
  EXPECT_EQ(associations[1], "101");
  EXPECT_EQ(associations[2], "0.75");  // (51 * 1 + 50 * 2) / 101 / 2
  EXPECT_EQ(associations[5], "101");
}

TEST(BagEvaluation, CountsBreaksAndNewIdentities) {
  const ScratchFolder folder;
  RecordingOptions options;
  options.lost = 40;
  options.found = 60;
  const std::string report = evaluateBag(makeBag(folder, options), withTruth("/truth"));
  const auto tracks = wordsAfter(report, "local tracks", "/sensors/cam/tracks");
  EXPECT_EQ(tracks[1], "81");
  EXPECT_NE(report.find("80.2 %"), std::string::npos) << report;  // 81 of 101
  EXPECT_EQ(tracks[tracks.size() - 3], "1");
  EXPECT_EQ(tracks[tracks.size() - 2], "1");
  EXPECT_EQ(wordsAfter(report, "GOSPA", "/sensors/cam/tracks")[4], "0.1980");
}

TEST(BagEvaluation, TakesItsTruthFromACsvFile) {
  const ScratchFolder folder;
  std::ostringstream csv;
  csv.precision(12);
  csv << "time,target,azimuth,elevation\n";
  for (int i = kInstants + 1; i >= -1; --i) {  // in any order
    const Eigen::Vector4d truth = truthAt(kStep * i);
    csv << kBagStart + kStep * i << ",drone," << truth(0) << "," << truth(1) << "\n";
  }
  const std::string report = evaluateBag(makeBag(folder), withTruth(folder.write("truth.csv", csv.str())));
  EXPECT_EQ(wordsAfter(report, "local tracks", "/sensors/cam/tracks")[2], "0.003536");
  EXPECT_LT(std::stod(wordsAfter(report, "local tracks", "/sensors/cam/tracks")[4]), 1e-4);  // rates, h^2 / 6
}

TEST(BagEvaluation, ASensorsOwnTruthIsForItsTopics) {
  const ScratchFolder folder;
  std::ostringstream csv;
  csv.precision(12);
  csv << "time,sensor,azimuth,elevation,range_m\n";
  for (int i = -1; i <= kInstants; ++i) {
    for (const std::string sensor : {"cam", "other"}) {
      const double offset = sensor == "cam" ? 0.0 : 1.0;
      csv << kBagStart + kStep * i << "," << sensor << "," << truthAt(kStep * i)(0) + offset << ",0.0,97.7\n";
    }
  }
  const std::string report = evaluateBag(makeBag(folder), withTruth(folder.write("truth.csv", csv.str())));
  EXPECT_EQ(wordsAfter(report, "local tracks", "/sensors/cam/tracks")[2], "0.003536");
  EXPECT_NE(report.find("101 messages of sensors without a truth on /fusion/tracks"), std::string::npos)
      << report;
}

TEST(BagEvaluation, ComparesAzimuthsAloneWhenAsked) {
  const ScratchFolder folder;
  std::ostringstream csv;
  csv.precision(12);
  csv << "time,target,azimuth,range_m\n";
  for (int i = -1; i <= kInstants; ++i)
    csv << kBagStart + kStep * i << ",1," << truthAt(kStep * i)(0) << ",100\n";
  BagEvaluationSettings settings = withTruth(folder.write("truth.csv", csv.str()));
  const std::string bag = makeBag(folder);
  try {
    evaluateBag(bag, settings);
    ADD_FAILURE() << "a truth without elevations was taken for one with";
  } catch (const std::exception& problem) {
    EXPECT_NE(std::string(problem.what()).find("--azimuth-only"), std::string::npos) << problem.what();
  }
  settings.evaluation.channels = sightline::core::Channels::azimuth_only;
  const std::string report = evaluateBag(bag, settings);
  EXPECT_EQ(wordsAfter(report, "local tracks", "/sensors/cam/tracks")[2], "0.003");
  EXPECT_EQ(wordsAfter(report, "sightings", "/sensors/cam/sightings")[2], "0.006");
}

TEST(BagEvaluation, WithoutTruthTheSightingsLieAboutTheirTracks) {
  const ScratchFolder folder;
  RecordingOptions options;
  options.lost = 40;
  options.found = 60;
  options.with_truth = false;
  const std::string report = evaluateBag(makeBag(folder, options), {});
  const auto residuals = wordsAfter(report, "sightings about tracks", "/sensors/cam/tracks");
  EXPECT_EQ(residuals[2], "cam");
  EXPECT_EQ(residuals[3], "81");
  EXPECT_EQ(residuals[4], "0.003536");  // (0.003, 0.004) between sighting and track
  EXPECT_EQ(residuals[5], "0.354");
  EXPECT_EQ(residuals[7], std::to_string(101 + 20));
  EXPECT_EQ(wordsAfter(report, "sightings about tracks", "/fusion/tracks")[3], "101");
  const auto spans = wordsAfter(report, "\ntracks", "/sensors/cam/tracks");
  EXPECT_EQ(spans[1], "2");
  EXPECT_EQ(spans[2], "2.00");  // 2.00 s and 1.95 s
  EXPECT_EQ(spans[3], "2.00");
  EXPECT_EQ(spans[6], "1");
  EXPECT_EQ(spans[7], "1.05");
  EXPECT_EQ(wordsAfter(report, "associations", "/sensors/cam/associations")[1], "101");
}

TEST(BagEvaluation, PointsToATruthThatIsNotUsed) {
  const ScratchFolder folder;
  EXPECT_NE(evaluateBag(makeBag(folder), {}).find("--truth /truth"), std::string::npos);
}

TEST(BagEvaluation, SaysWhatIsMissing) {
  const ScratchFolder folder;
  const std::string bag = makeBag(folder);
  const auto complaint = [&](const std::string& file, const std::string& truth) -> std::string {
    try {
      evaluateBag(file, withTruth(truth));
    } catch (const std::exception& problem) {
      return problem.what();
    }
    return "";
  };
  EXPECT_NE(complaint(folder.file("none.bag"), "").find("none.bag"), std::string::npos);
  const std::string wrong_topic = complaint(bag, "/truht");
  EXPECT_NE(wrong_topic.find("/truht"), std::string::npos) << wrong_topic;
  EXPECT_NE(wrong_topic.find(" /truth"), std::string::npos) << wrong_topic;  // what there is
  EXPECT_NE(complaint(bag, folder.write("a.csv", "time,elevation\n1,2\n")).find("azimuth"),
            std::string::npos);
  EXPECT_NE(complaint(bag, folder.write("b.csv", "time,azimuth,elevation\n100,57.3,12\n")).find("degrees"),
            std::string::npos);
  EXPECT_NE(complaint(bag, folder.write("c.csv", "time,azimuth,elevation\n")).find("no sample"),
            std::string::npos);
}

TEST(BagEvaluation, WritesWhatItComparedForPlots) {
  const ScratchFolder folder;
  BagEvaluationSettings settings = withTruth("/truth");
  settings.csv = folder.file("plots");
  evaluateBag(makeBag(folder), settings);
  std::ifstream errors(folder.file("plots") + "/errors.csv"), gospa(folder.file("plots") + "/gospa.csv");
  const auto count = [](std::ifstream& stream) {
    int lines = 0;
    for (std::string line; std::getline(stream, line);) ++lines;
    return lines;
  };
  EXPECT_EQ(count(errors), 1 + 3 * kInstants);
  EXPECT_EQ(count(gospa), 1 + 2 * kInstants);
}

/// Lines of a CSV file as cells by name of the column.
std::vector<std::map<std::string, std::string>> rowsOfCsv(const std::string& path) {
  const auto cellsOf = [](const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char letter : line) letter == ',' ? cells.emplace_back() : cells.back() += letter;
    return cells;
  };
  std::ifstream stream(path);
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> names = cellsOf(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = cellsOf(line);
    EXPECT_EQ(cells.size(), names.size()) << line;
    rows.emplace_back();
    for (std::size_t i = 0; i < std::min(cells.size(), names.size()); ++i) rows.back()[names[i]] = cells[i];
  }
  return rows;
}

TEST(BagEvaluation, WritesWhatItFoundForPrograms) {
  const ScratchFolder folder;
  RecordingOptions options;
  options.lost = 40;
  options.found = 60;
  BagEvaluationSettings settings = withTruth("/truth");
  settings.csv = folder.file("csv");
  const std::string report = evaluateBag(makeBag(folder, options), settings);
  auto rows = rowsOfCsv(folder.file("csv") + "/evaluation.csv");
  ASSERT_EQ(rows.size(), 5u);  // sightings, two trackers, and the target of each of these
  EXPECT_EQ(rows[0]["kind"], "sightings");
  EXPECT_EQ(rows[0]["confirm_median"], "");
  EXPECT_EQ(rows[1]["topic"], "/sensors/cam/tracks");
  EXPECT_EQ(rows[1]["target"], "");
  EXPECT_EQ(rows[1]["tracks"], "2");
  EXPECT_EQ(rows[1]["false_tracks"], "0");
  EXPECT_EQ(rows[1]["purity"], "1");
  EXPECT_NEAR(std::stod(rows[1]["completeness"]), 41.0 / 101.0, 1e-6);  // the longer one from instant 60 on
  EXPECT_NEAR(std::stod(rows[1]["judged_time"]), 5.0, 1e-6);
  EXPECT_NEAR(std::stod(rows[1]["confirm_worst"]), 0.0, 1e-6);
  EXPECT_EQ(rows[3]["kind"], "target");
  EXPECT_EQ(rows[3]["target"], "1");
  EXPECT_EQ(rows[3]["breaks"], "1");
  EXPECT_NEAR(std::stod(rows[3]["rmse"]), 0.005 / std::sqrt(2.0), 1e-6);
  EXPECT_EQ(rows[3]["purity"], "");
  EXPECT_EQ(wordsAfter(report, "completeness", "/sensors/cam/tracks")[6], "2");  // tracks
  EXPECT_EQ(wordsAfter(report, "each target", "/sensors/cam/tracks")[1], "1");   // the target
}

TEST(BagEvaluation, WithoutATruthWritesTheResidualsForPrograms) {
  const ScratchFolder folder;
  RecordingOptions options;
  options.with_truth = false;
  BagEvaluationSettings settings;
  settings.csv = folder.file("csv");
  evaluateBag(makeBag(folder, options), settings);
  auto rows = rowsOfCsv(folder.file("csv") + "/evaluation.csv");
  ASSERT_EQ(rows.size(), 2u);  // of the fusion and of the sensor's tracker
  EXPECT_EQ(rows[1]["topic"], "/sensors/cam/tracks");
  EXPECT_EQ(rows[1]["name"], "cam");
  EXPECT_EQ(rows[1]["samples"], "101");
  EXPECT_EQ(rows[1]["tracks"], "1");
  EXPECT_NEAR(std::stod(rows[1]["rmse"]), 0.005 / std::sqrt(2.0), 1e-6);
}

TEST(BagEvaluation, SaysThatItsFilesCannotBeWritten) {
  const ScratchFolder folder;
  BagEvaluationSettings settings = withTruth("/truth");
  settings.csv = folder.write("taken", "") + "/csv";
  EXPECT_THROW(evaluateBag(makeBag(folder), settings), std::runtime_error);
}

TEST(BagEvaluation, ThePlotsAreDrawn) {
  if (std::system("/usr/bin/python3 -c 'import matplotlib' 2>/dev/null") != 0)
    GTEST_SKIP() << "no matplotlib";
  const ScratchFolder folder;
  BagEvaluationSettings settings = withTruth("/truth");
  settings.csv = folder.file("plots");
  evaluateBag(makeBag(folder), settings);
  const std::string script = sightline::test::sourceDirectory() + "/scripts/plot_evaluation ";
  ASSERT_EQ(std::system(("/usr/bin/python3 " + script + settings.csv + " >/dev/null").c_str()), 0);
  for (const char* name : {"overview.png", "comparison.png", "gospa.png", "errors_sensors_cam_tracks.png"}) {
    EXPECT_GT(std::filesystem::file_size(settings.csv + "/" + name), 1000u) << name;
  }
}

}  // namespace
