// `evaluate --html` on small bags, and the files that its page is made of.
#include "sightline/ros/recordings/report_data.h"

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <rosbag/bag.h>
#include <sightline/AssociationArray.h>
#include <sightline/FusionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <std_msgs/String.h>

#include "sightline/report/evaluation_text.h"
#include "sightline/ros/recordings/replay.h"

#include "support/command.h"
#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

using sightline_ros::truthTopicOf;
using sightline_ros::writeReportData;

const char* const kHostile = "cam,\"1\"</script><img src=x onerror=alert(1)>'&amp;";

sightline::Track trackAt(double azimuth, double sigma) {
  sightline::Track track;
  track.id = 7;
  track.status = sightline::Track::CONFIRMED;
  track.azimuth = azimuth;
  track.covariance.fill(0.0);
  for (int i = 0; i < 4; ++i) track.covariance[5 * i] = sigma * sigma;
  return track;
}

/// Twenty seconds of one target at rest, a track that is `error` [rad] off, and a sensor that is called
/// noisy after ten seconds.
std::string makeBag(const std::string& path, bool with_truth, double error = 0.001,
                    const std::string& sensor = "cam") {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  for (int i = 0; i < 400; ++i) {
    const ros::Time stamp(100.0 + 0.05 * i);
    sightline::TrackArray tracks;
    tracks.header.stamp = stamp;
    tracks.header.frame_id = "platform_enu";
    tracks.tracker = sensor;
    tracks.estimator = "noga";
    tracks.tracks = {trackAt(0.3 + error * std::sin(i), 0.001)};
    tracks.tracks[0].sources = {sensor};
    bag.write("/sensors/cam/tracks", stamp, tracks);
    tracks.tracks = {trackAt(0.3, 0.0)};
    if (with_truth) bag.write("/truth", stamp, tracks);

    sightline::SightingArray scan;
    scan.header = tracks.header;
    scan.sensor = sensor;
    scan.ifov = scan.detection_probability = scan.clutter_density = std::nan("");
    scan.sightings.resize(1);
    scan.sightings[0].azimuth = 0.3 + 0.002 * std::cos(i);
    scan.sightings[0].covariance = {4e-6, 0.0, 0.0, 4e-6};
    bag.write("/sensors/cam/sightings", stamp, scan);

    sightline::AssociationArray associations;
    associations.header = tracks.header;
    associations.associations.resize(1);
    associations.associations[0].decision = sightline::Association::ACCEPTED;
    associations.associations[0].distance_squared = 3.0;
    bag.write("/sensors/cam/associations", stamp, associations);

    sightline::FusionReport report;
    report.header = tracks.header;
    report.tracks.resize(1);
    report.tracks[0].rule = "tracklets";
    report.tracks[0].sensors.resize(1);
    report.tracks[0].sensors[0].sensor = sensor;
    report.tracks[0].sensors[0].verdict = i < 200 ? "healthy" : "noisy";
    report.tracks[0].sensors[0].noise_scale = i < 200 ? 1.0 : 4.0;
    bag.write("/fusion/report", stamp, report);
  }
  return path;
}

/// As the console prints it of the tracks.
std::string rmseIn(const std::string& tables) {
  std::istringstream words(tables.substr(tables.find("/sensors/cam/tracks")));
  std::string topic, samples, rmse;
  words >> topic >> samples >> rmse;
  return rmse;
}

std::pair<int, std::string> evaluate(const std::string& arguments) {
  return outcomeOf(std::string(SIGHTLINE_TOOLS_DIR) + "/evaluate " + arguments);
}

TEST(ReportData, TellsInnovationsLivesSensorsAndSettings) {
  const ScratchFolder folder;
  const std::string data = folder.file("run.bag").substr(0, folder.file("run.bag").rfind('/'));
  const rosbag::Bag bag(makeBag(folder.file("run.bag"), true), rosbag::bagmode::Read);
  writeReportData(bag, data);
  EXPECT_NE(textOfFile(data + "/innovations.csv").find(",4,1.5\n"), std::string::npos);  // 4 in 0.2 s
  EXPECT_NE(textOfFile(data + "/lives.csv").find("/sensors/cam/tracks,7,100.000,119.950\n"),
            std::string::npos);
  EXPECT_NE(textOfFile(data + "/sensors.csv").find(",cam,noisy,4,"), std::string::npos);
  EXPECT_NE(textOfFile(data + "/recorded.csv").find("/sensors/cam/tracks,estimator,noga\n"),
            std::string::npos);
  EXPECT_NE(textOfFile(data + "/recorded.csv").find("/fusion/report,rule,tracklets\n"), std::string::npos);
}

TEST(ReportData, TheTruthOfARecordingIsItsOwn) {
  const ScratchFolder folder;
  const rosbag::Bag with(makeBag(folder.file("with.bag"), true), rosbag::bagmode::Read);
  EXPECT_EQ(truthTopicOf(with), "/truth");
  const rosbag::Bag without(makeBag(folder.file("without.bag"), false), rosbag::bagmode::Read);
  EXPECT_EQ(truthTopicOf(without), "");
}

TEST(HtmlReport, HasTheConsolesFiguresAndAsksForNothing) {
  if (!hasPlotly()) GTEST_SKIP() << "no plotly: install python3-plotly";
  const ScratchFolder folder;
  const std::string bag = makeBag(folder.file("run.bag"), true), page = folder.file("report.html");
  const auto [code, tables] = evaluate("--html " + page + " " + bag);
  ASSERT_EQ(code, 0) << tables;
  const std::string text = textOfFile(page);
  const std::string body = text.substr(text.find("<body"));
  std::istringstream words(tables.substr(tables.find("/sensors/cam/tracks")));
  std::string word;
  for (int i = 0; i < 4 && words >> word; ++i)  // topic, samples, RMSE, RMSE/sigma
    EXPECT_NE(body.find("<td>" + word + "</td>"), std::string::npos) << word;
  EXPECT_NE(text.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(body.find("src=\"http"), std::string::npos);
  EXPECT_NE(body.find("noisy"), std::string::npos);
  for (const char* key :
       {"\"scene\"", "\"errors\"", "\"nees\"", "\"nis\"", "\"gospa\"", "\"identities\"", "\"sensors\""})
    EXPECT_NE(body.find(key), std::string::npos) << key;
}

TEST(HtmlReport, SaysOfARecordingWithoutATruthThatItHasNone) {
  if (!hasPlotly()) GTEST_SKIP() << "no plotly: install python3-plotly";
  const ScratchFolder folder;
  const std::string bag = makeBag(folder.file("run.bag"), false), page = folder.file("report.html");
  const auto [code, printed] = evaluate("--html " + page + " " + bag);
  ASSERT_EQ(code, 0) << printed;
  EXPECT_NE(textOfFile(page).find("there is no truth"), std::string::npos);
}

TEST(HtmlReport, OfTwoRecordingsTellsTheDifferenceTheSameEveryTime) {
  if (!hasPlotly()) GTEST_SKIP() << "no plotly: install python3-plotly";
  const ScratchFolder folder;
  const std::string bag = makeBag(folder.file("run.bag"), true, 0.002);
  const std::string other = makeBag(folder.file("other.bag"), true, 0.001);
  std::string pages[2], rmse[2];
  for (std::string& page : pages) {
    const std::string file = folder.file("report.html");
    const auto [code, printed] = evaluate("--html " + file + " " + bag + " --against " + other);
    ASSERT_EQ(code, 0) << printed;
    page = textOfFile(file);
    rmse[0] = rmseIn(printed);
    rmse[1] = rmseIn(printed.substr(printed.find(other + ":")));
  }
  EXPECT_EQ(pages[0], pages[1]);
  // Its two columns are the consoles' figures.
  EXPECT_NE(pages[0].find("<tr class=\"differs\"><td>RMSE [rad]</td><td>" + rmse[0] + "</td><td>" + rmse[1] +
                          "</td>"),
            std::string::npos);
}

TEST(HtmlReport, TellsWhichParametersOfTheReplaysDiffer) {
  if (!hasPlotly()) GTEST_SKIP() << "no plotly: install python3-plotly";
  const ScratchFolder folder;
  const std::string bag = makeBag(folder.file("run.bag"), true), page = folder.file("report.html");
  sightline_ros::ReplaySettings settings;
  sightline_ros::replay(bag, folder.file("default.bag"), settings);
  settings.config = folder.write("config.yaml", "local_tracker: {lifecycle: {confirm_hits: 4}}\n");
  sightline_ros::replay(bag, folder.file("other.bag"), settings);
  const auto [code, printed] = evaluate("--html " + page + " " + folder.file("default.bag") + " --against " +
                                        folder.file("other.bag"));
  ASSERT_EQ(code, 0) << printed;
  EXPECT_NE(textOfFile(page).find("<tr class=\"differs\"><td>/replay/parameters</td>"
                                  "<td>local_tracker/lifecycle/confirm_hits</td><td>-</td><td>4</td>"),
            std::string::npos);
}

TEST(ReportData, TellsTheParametersOfNodesThatWereRecordedLive) {
  const ScratchFolder folder;
  const std::string path = makeBag(folder.file("run.bag"), true);
  {
    rosbag::Bag bag(path, rosbag::bagmode::Append);
    std_msgs::String parameters;
    parameters.data = "gate/probability: 0.9\nrule: best\n";
    bag.write("/fusion/parameters", ros::Time(101.0), parameters);
    bag.write("/fusion/words", ros::Time(101.0), parameters);
  }
  const std::string data = path.substr(0, path.rfind('/'));
  writeReportData(rosbag::Bag(path), data);
  const std::string recorded = textOfFile(data + "/recorded.csv");
  EXPECT_NE(recorded.find("/fusion/parameters,gate/probability,0.9\n"), std::string::npos) << recorded;
  EXPECT_NE(recorded.find("/fusion/parameters,rule,best\n"), std::string::npos) << recorded;
  EXPECT_EQ(recorded.find("/fusion/words"), std::string::npos) << recorded;
}

/// Two targets at rest, of which the second has no track in the first half: its cutoff then counts.
TEST(HtmlReport, HasTheGospaOfPositionsOverTime) {
  const ScratchFolder folder;
  const std::string path = folder.file("positions.bag"), page = folder.file("report.html");
  {
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    for (int i = 0; i < 100; ++i) {
      sightline::PositionTrackArray array;
      array.header.stamp = ros::Time(100.0 + 0.1 * i);
      array.header.frame_id = "world";
      array.tracks.resize(2);
      for (std::uint32_t k = 0; k < 2; ++k) {
        array.tracks[k].id = k + 1;
        array.tracks[k].status = sightline::PositionTrack::CONFIRMED;
        array.tracks[k].position.x = 100.0 * k;
        for (std::size_t axis = 0; axis < 6; ++axis) array.tracks[k].covariance[7 * axis] = 1.0;
      }
      bag.write("/truth/positions", array.header.stamp, array);
      if (i < 50) array.tracks.resize(1);
      for (auto& track : array.tracks) track.position.y = 1.0;
      bag.write("/positions/tracks", array.header.stamp, array);
    }
  }
  const auto [code, printed] = evaluate("--csv " + folder.file("csv") + " --truth /truth/positions " + path);
  ASSERT_EQ(code, 0) << printed;
  const std::string gospa = textOfFile(folder.file("csv") + "/position_gospa.csv");
  // (1^2 + 10^2/2)^(1/2) with one target missed, then 2^(1/2).
  EXPECT_NE(gospa.find("/positions/tracks,101.000000000,7.14"), std::string::npos) << gospa;
  EXPECT_NE(gospa.find(",1,1,0\n"), std::string::npos) << gospa;
  EXPECT_NE(gospa.find("/positions/tracks,108.000000000,1.41"), std::string::npos) << gospa;
  if (!hasPlotly()) GTEST_SKIP() << "no plotly: install python3-plotly";
  ASSERT_EQ(evaluate("--html " + page + " " + path).first, 0);
  EXPECT_NE(textOfFile(page).find("\"gospa\""), std::string::npos);
  EXPECT_NE(textOfFile(page).find("missed targets"), std::string::npos);
}

TEST(HtmlReport, SaysInOneLineWhatIsMissing) {
  const ScratchFolder folder;
  const std::string bag = makeBag(folder.file("run.bag"), true), page = folder.file("report.html");
  folder.write("plotly.py", "raise ImportError('no plotly here')\n");
  const std::string path = folder.file("plotly.py").substr(0, folder.file("plotly.py").rfind('/'));
  const auto [code, printed] = outcomeOf("PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" + path + " " +
                                         SIGHTLINE_TOOLS_DIR + "/evaluate --html " + page + " " + bag);
  EXPECT_EQ(code, 1);
  EXPECT_NE(printed.find("install python3-plotly"), std::string::npos) << printed;
  EXPECT_EQ(printed.find("Traceback"), std::string::npos) << printed;
  EXPECT_EQ(textOfFile(page), "");
}

TEST(HtmlReport, OfNothingComparedIsAnErrorThatNamesTheRecording) {
  const ScratchFolder folder;
  const std::string page = folder.file("report.html");
  rosbag::Bag(folder.file("empty.bag"), rosbag::bagmode::Write).close();
  for (const std::string& bag : {folder.file("empty.bag"), folder.write("text.bag", "no bag\n")}) {
    const auto [code, printed] = evaluate("--html " + page + " " + bag);
    EXPECT_EQ(code, 1) << printed;
    EXPECT_TRUE(printed.find(bag) != std::string::npos || !hasPlotly()) << printed;
    EXPECT_EQ(printed.find("Traceback"), std::string::npos) << printed;
    EXPECT_EQ(textOfFile(page), "");
  }
}

TEST(HtmlReport, ItsBandsAreTheConsoles) {
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) GTEST_SKIP() << "no numpy";
  const std::string scripts = sightline::test::sourceDirectory() + "/scripts";
  const auto [code, printed] =
      outcomeOf("PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" + scripts +
                " /usr/bin/python3 -c 'from evaluation.statistics import text_with_band as text; "
                "print(text(1.234, 200), text(0.5, 7), text(1.0012, 400000))'");
  ASSERT_EQ(code, 0) << printed;
  EXPECT_EQ(printed, sightline::report::withBand(1.234, 200.0) + " " + sightline::report::withBand(0.5, 7.0) +
                         " " + sightline::report::withBand(1.0012, 400000.0) + "\n");
}

TEST(HtmlReport, NamesOfTheDataAreNoCode) {
  if (!hasPlotly()) GTEST_SKIP() << "no plotly: install python3-plotly";
  const ScratchFolder folder;
  const std::string bag = makeBag(folder.file("run.bag"), true, 0.001, kHostile);
  const std::string page = folder.file("report.html");
  const auto [code, printed] = evaluate("--html " + page + " " + bag);
  ASSERT_EQ(code, 0) << printed;
  const std::string text = textOfFile(page);
  EXPECT_EQ(text.find("<img src=x"), std::string::npos);
  EXPECT_NE(text.find("&lt;img src=x"), std::string::npos);
}

TEST(HtmlReport, RefusesItsInputAndAgainstAlone) {
  const ScratchFolder folder;
  const std::string bag = makeBag(folder.file("run.bag"), true), before = textOfFile(bag);
  EXPECT_EQ(evaluate("--html " + bag + " " + bag).first, 1);
  EXPECT_EQ(textOfFile(bag), before);
  const auto [code, printed] = evaluate("--against " + bag + " " + bag);
  EXPECT_NE(code, 0);
  EXPECT_NE(printed.find("--html"), std::string::npos) << printed;
}

TEST(HtmlReport, OpensInABrowserAndIsReadByClicks) {
  const std::string python = "/usr/bin/python3 ";
  if (!hasPlotly() || std::system((python + "-c 'import selenium' 2>/dev/null").c_str()) != 0 ||
      std::system("test -x /usr/bin/chromedriver -a -x /usr/bin/chromium") != 0)
    GTEST_SKIP() << "no browser: install chromium, chromium-driver and python3-selenium";
  const ScratchFolder folder;
  const std::string bag = makeBag(folder.file("run.bag"), true), page = folder.file("report.html");
  const auto [written, printed] = evaluate("--html " + page + " " + bag);
  ASSERT_EQ(written, 0) << printed;
  const auto [code, said] =
      outcomeOf(python + sightline::test::sourceDirectory() + "/test/ros/recordings/click_report " + page);
  EXPECT_EQ(code, 0) << said;
}

}  // namespace
