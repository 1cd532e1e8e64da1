// What is printed is read by python3's json module.
#include "sightline/ros/outputs/track_json.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "support/command.h"
#include "support/output_tracks.h"
#include "support/scratch_folder.h"

namespace {

using sightline::PositionTrackArray;
using sightline::TrackArray;
using sightline::test::directionTrack;
using sightline::test::positionTrack;
using sightline::test::stamped;
using sightline_ros::jsonOf;
using sightline_ros::OutputChoice;

/// What python prints of expressions of `m`, the message that the line is.
std::string pythonOf(const std::string& line, const std::string& expression) {
  const ScratchFolder folder;
  const std::string script = folder.write("read.py",
                                          "import decimal, json, sys\n"
                                          "def refuse(word): raise ValueError(word)\n"
                                          "m = json.load(open(sys.argv[1], encoding='utf-8'), "
                                          "parse_constant=refuse, parse_float=decimal.Decimal)\n"
                                          "print(" +
                                              expression + ")\n");
  const auto [code, printed] = outcomeOf("python3 " + script + " " + folder.write("line.json", line));
  EXPECT_EQ(code, 0) << printed << line;
  return printed;
}

TEST(TrackJson, PythonReadsDirections) {
  auto message = stamped<TrackArray>(ros::Time(1795864649, 5), "platform_enu");
  message.tracks = {directionTrack(3, 0.1, -0.25, 1e-9), directionTrack(4, 1.0, 0.0)};
  message.tracks[0].existence = std::nan("");
  message.tracks[0].azimuth_rate = -std::numeric_limits<double>::infinity();
  message.tracks[0].sources = {"left", "right"};
  message.tracks[1].status = sightline::Track::TENTATIVE;
  const std::string line = jsonOf(message, "/fusion/tracks", {});
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_EQ(pythonOf(line, "m['topic'], m['stamp'], m['frame'], m['tracker'], len(m['tracks'])"),
            "/fusion/tracks 1795864649.000000005 platform_enu tracker 1\n");
  EXPECT_EQ(
      pythonOf(line, "[m['tracks'][0][k] for k in ('id', 'status', 'existence', 'azimuth_rate', 'sources')]"),
      "[3, 'confirmed', None, None, ['left', 'right']]\n");
  EXPECT_EQ(pythonOf(line,
                     "float(m['tracks'][0]['elevation']), len(m['tracks'][0]['covariance']), "
                     "float(m['tracks'][0]['covariance'][0]) == 1e-9 ** 2"),
            "-0.25 16 True\n");
}

TEST(TrackJson, PythonReadsPositions) {
  auto message = stamped<PositionTrackArray>(ros::Time(12.5), "world");
  message.tracks = {positionTrack(3, {1.0, -2.0, std::nan("")}, {0.5, 0.0, 0.0})};
  const std::string line = jsonOf(message, "/positions/tracks", {});
  EXPECT_EQ(pythonOf(line, "m['tracks'][0]['position'], len(m['tracks'][0]['covariance'])"),
            "[1, -2, None] 36\n");
}

TEST(TrackJson, TentativeTracksWhenAskedForAndEmptyMessagesToo) {
  auto message = stamped<TrackArray>(ros::Time(12.5), "world");
  EXPECT_EQ(pythonOf(jsonOf(message, "/t", {}), "m['tracks']"), "[]\n");
  message.tracks = {directionTrack(3, 0.1, -0.25)};
  message.tracks[0].status = sightline::Track::TENTATIVE;
  EXPECT_EQ(pythonOf(jsonOf(message, "/t", {}), "m['tracks']"), "[]\n");
  OutputChoice all;
  all.tentative = true;
  EXPECT_EQ(pythonOf(jsonOf(message, "/t", all), "m['tracks'][0]['status']"), "tentative\n");
}

TEST(TrackJson, AnyBytesMakeATextThatPythonReads) {
  auto message = stamped<TrackArray>(ros::Time(12.5), "world");
  message.tracker =
      "quote \" backslash \\ line\n \xC3\xA9 \xF0\x9F\x9B\xB0 \xFF \xC0\xAF \xED\xA0\x80 \xE2\x82";
  EXPECT_EQ(pythonOf(jsonOf(message, "/t", {}), "ascii(m['tracker'])"),
            "'quote \" backslash \\\\ line\\n \\xe9 \\U0001f6f0 \\ufffd \\ufffd\\ufffd \\ufffd\\ufffd\\ufffd "
            "\\ufffd\\ufffd'\n");
}

}  // namespace
