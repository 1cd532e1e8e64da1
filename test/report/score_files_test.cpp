#include "sightline/report/score_files.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/scratch_folder.h"

using namespace sightline::report;
namespace core = sightline::core;

namespace {

core::ScoredPair pair() {
  core::ScoredPair pair;
  pair.topic = "/tracks";
  pair.name = "tracker";
  pair.time = core::timeOf(1'500'000'000);
  pair.target = 2;
  pair.track = 9;
  pair.angles = {0.5, 0.25};
  pair.truth = {0.375, 0.125};
  pair.error.position = {0.125, 0.0625};
  pair.error.sigma = {0.5, 0.25};
  pair.error.position_nees = 0.75;
  return pair;
}

TEST(ScoreFiles, HoldALineForEachPairAndReport) {
  const ScratchFolder folder;
  {
    ScoreFiles files(folder.file("scores"));
    const core::ScoreListener listener = files.listener();
    listener.pair(pair());
    core::ScoredReport report;
    report.topic = "/tracks";
    report.time = core::timeOf(2'000'000'000);
    report.gospa.distance = 0.5;
    report.gospa.missed = 1;
    report.gospa.extra = 3;
    report.ospa.distance = 0.25;
    listener.report(report);
    files.finish();
  }
  EXPECT_EQ(textOfFile(folder.file("scores/errors.csv")),
            "topic,name,time,target,track,azimuth,elevation,truth_azimuth,truth_elevation,error_azimuth,"
            "error_elevation,sigma_azimuth,sigma_elevation,nees_position,nees_state\n"
            "/tracks,tracker,1.5,2,9,0.5,0.25,0.375,0.125,0.125,0.0625,0.5,0.25,0.750000,\n");
  EXPECT_EQ(textOfFile(folder.file("scores/gospa.csv")),
            "topic,time,distance,localisation,missed,false,ospa\n/tracks,2,0.5,0,1,3,0.25\n");
}

TEST(ScoreFiles, AFolderThatCannotBeCreatedIsAnError) {
  const ScratchFolder folder;
  EXPECT_THROW(ScoreFiles(folder.write("file", "") + "/below"), std::runtime_error);
}

}  // namespace
