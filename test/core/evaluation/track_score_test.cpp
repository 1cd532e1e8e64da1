#include "sightline/core/evaluation/track_score.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

using namespace sightline::core;

namespace {

constexpr double kGate = 0.03;  // [rad]

TrueTarget target(std::uint32_t id, double azimuth, double age = 100.0) {
  TrueTarget result;
  result.id = id;
  result.state.mean << azimuth, 0.0, 0.0, 0.0;
  result.age = age;
  return result;
}

Track track(std::uint32_t id, double azimuth, TrackStatus status = TrackStatus::confirmed) {
  Track result;
  result.id = id;
  result.status = status;
  result.state.mean << azimuth, 0.0, 0.0, 0.0;
  result.state.covariance.setIdentity();
  return result;
}

TrackReport report(double time, std::vector<Track> tracks) {
  return {timeOf(1'000'000'000'000) + durationOf(time), "tracker", false, std::move(tracks)};
}

TrackScore score() {
  return {"tracks", Channels::azimuth_and_elevation, GospaParams{0.01, 2.0}};
}

TEST(TrackScore, ATargetKeepsItsTrackUnlessAnotherIsNearerByMoreThanTheMargin) {
  // The margin is a third of the gate, 0.01: track 2 comes within 0.005 and track 1 is 0.0111 or 0.0113 away.
  for (const double kept_at : {0.0111, 0.0113}) {
    TrackScore result = score();
    result.add(report(0.0, {track(1, 0.0)}), {target(7, 0.0)}, kGate, {});
    std::uint32_t chosen = 0;
    result.add(report(0.1, {track(1, kept_at), track(2, -0.005)}), {target(7, 0.0)}, kGate,
               {[&](const ScoredPair& pair) { chosen = pair.track; }, {}});
    EXPECT_EQ(chosen, kept_at < 0.0112 ? 1u : 2u);  // 0.0112^2 = 0.005^2 + 0.01^2
    EXPECT_EQ(result.continuity().idSwitches(), kept_at < 0.0112 ? 0u : 1u);
    EXPECT_EQ(result.unmatched(), 1u);
  }
}

TEST(TrackScore, OnlyEstablishedFiniteTracksCount) {
  TrackScore result = score();
  const TrackReport mixed = report(0.0, {track(1, 0.0, TrackStatus::tentative), track(2, std::nan("")),
                                         track(3, 0.02, TrackStatus::coasting)});
  result.note(mixed);
  result.add(mixed, {target(7, 0.0)}, kGate, {});
  EXPECT_EQ(result.tracksNow(), 1);
  EXPECT_NEAR(result.anglesNow().x(), 0.02, 1e-12);
  EXPECT_EQ(result.lives().tracks(), 1u);
  EXPECT_EQ(result.unmatched(), 0u);
  EXPECT_NEAR(result.errors().rmse(), 0.02 / std::sqrt(2.0), 1e-9);
}

TEST(TrackScore, TheTrackOfATargetThatIsNotScoredIsNoFalseOne) {
  TrackScore result = score();
  TrueTarget young = target(7, 0.0, 0.1);
  young.is_scored = false;
  std::optional<Gospa> gospa;
  result.add(report(0.0, {track(1, 0.001)}), {young}, kGate,
             {{}, [&](const ScoredReport& scored) { gospa = scored.gospa; }});
  ASSERT_TRUE(gospa);
  EXPECT_EQ(gospa->extra + gospa->missed + gospa->assigned, 0);
  EXPECT_EQ(result.errors().samples(), 0u);
  EXPECT_EQ(result.unmatched(), 0u);
  EXPECT_TRUE(result.targets().empty());
}

TEST(TrackScore, ATargetThatLeftAndCameBackMayHaveAnotherTrack) {
  for (const double age : {0.5, 100.0}) {
    TrackScore result = score();
    result.add(report(0.0, {track(1, 0.0)}), {target(7, 0.0)}, kGate, {});
    result.add(report(1.0, {track(2, 0.0)}), {target(7, 0.0, age)}, kGate, {});
    EXPECT_EQ(result.continuity().idSwitches(), age < 1.0 ? 0u : 1u);
    EXPECT_EQ(result.appearances().count(), age < 1.0 ? 2u : 1u);
  }
}

TEST(TrackScore, ScoredTimeLeavesOutSilencesAndStepsBack) {
  TrackScore result = score();
  for (const double time : {0.0, 1.5, 10.0, 11.0, 10.5})
    result.add(report(time, {}), {target(7, 0.0)}, kGate, {});
  EXPECT_NEAR(result.scoredTime(), 1.5 + 1.0, 1e-9);
}

TEST(TrackScore, RestartForgetsIdentitiesAndKeepsTheFigures) {
  TrackScore result = score();
  result.add(report(0.0, {track(1, 0.0)}), {target(7, 0.0)}, kGate, {});
  result.restart();
  result.add(report(0.1, {track(2, 0.0)}), {target(7, 0.0)}, kGate, {});
  EXPECT_EQ(result.continuity().idSwitches(), 0u);
  EXPECT_EQ(result.errors().samples(), 2u);
  EXPECT_EQ(result.appearances().count(), 2u);
  EXPECT_EQ(result.targets().at(7).reports, 2u);
}

}  // namespace
