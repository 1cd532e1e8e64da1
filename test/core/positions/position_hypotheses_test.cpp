#include "sightline/core/positions/position_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kSigma = 1e-3;      // [rad]
constexpr double kRateSigma = 3e-3;  // [rad/s]

struct Target {
  Vector position, velocity;
};

LocalView viewOf(int station, std::uint32_t track, const Vector& origin, const Target& target,
                 RandomStream& random) {
  LocalView view;
  view.key = {station, track};
  view.ray.origin = origin;
  const Vector to = target.position - origin, u = to.normalized();
  const Eigen::Matrix<double, 2, 3> B = acrossBasis(u);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - u * u.transpose();
  view.ray.direction = (u + B.transpose() * kSigma * random.normalPair()).normalized();
  view.ray.covariance = kSigma * kSigma * across;
  view.ray.motion =
      RayMotion{across * target.velocity / to.norm() + B.transpose() * kRateSigma * random.normalPair(),
                kRateSigma * kRateSigma * across, Vector::Zero()};
  return view;
}

const std::vector<Vector> kStations{{0, 0, 0}, {120, 0, 2}, {40, 110, 5}, {-60, 60, 0}};

std::vector<LookingStation> looking(int stations) {
  std::vector<LookingStation> all;
  for (int s = 0; s < stations; ++s)
    all.push_back({s, kStations[static_cast<std::size_t>(s)], FieldOfView{}});
  return all;
}

/// Track ids are 1 + target, so that a candidate is right when all its ids are one.
std::vector<LocalView> viewsOf(const std::vector<Target>& targets, int stations, RandomStream& random) {
  std::vector<LocalView> views;
  for (int s = 0; s < stations; ++s)
    for (std::size_t t = 0; t < targets.size(); ++t)
      views.push_back(viewOf(s, static_cast<std::uint32_t>(t + 1), kStations[static_cast<std::size_t>(s)],
                             targets[t], random));
  return views;
}

bool isRight(const Candidate& candidate) {
  return std::all_of(candidate.members.begin(), candidate.members.end(),
                     [&](const ViewKey& key) { return key.track == candidate.members.front().track; });
}

std::vector<Target> swarm(int count, RandomStream& random) {
  std::vector<Target> targets;
  for (int i = 0; i < count; ++i) {
    const Vector position(20 + 60 * random.uniform(), 20 + 60 * random.uniform(), 10 + 40 * random.uniform());
    const Vector velocity(10 * random.uniform() - 5, 10 * random.uniform() - 5, 2 * random.uniform() - 1);
    targets.push_back({position, velocity});
  }
  return targets;
}

TEST(PositionHypotheses, OneTargetOfTwoStationsIsFoundAtOnce) {
  RandomStream random(1);
  PositionHypotheses hypotheses;
  const Target target{{50, 60, 20}, {3, 2, 1}};
  const auto decision = hypotheses.decide(Time(durationOf(1.0)), viewsOf({target}, 2, random), looking(2));
  ASSERT_EQ(decision.targets.size(), 1u);
  EXPECT_EQ(decision.targets[0].members, (std::vector<ViewKey>{{0, 1}, {1, 1}}));
  EXPECT_LT((decision.targets[0].at.point - target.position).norm(), 0.5);
  EXPECT_TRUE(decision.refused.empty());
}

TEST(PositionHypotheses, TracksOfDifferentTargetsAreNotOne) {
  RandomStream random(2);
  PositionHypotheses hypotheses;
  std::vector<LocalView> views{viewOf(0, 1, kStations[0], {{50, 60, 20}, {3, 2, 1}}, random),
                               viewOf(1, 1, kStations[1], {{50, 60, 40}, {-3, 2, 1}}, random)};
  EXPECT_TRUE(hypotheses.decide(Time(durationOf(1.0)), views, looking(2)).targets.empty());
}

TEST(PositionHypotheses, ASwarmIsSortedOutByThreeStations) {
  int right = 0, wrong = 0, complete = 0;
  for (std::uint64_t run = 1; run <= 20; ++run) {
    RandomStream random(run);
    const auto targets = swarm(10, random);
    PositionHypotheses hypotheses;
    const auto decision = hypotheses.decide(Time(durationOf(1.0)), viewsOf(targets, 4, random), looking(4));
    EXPECT_TRUE(decision.is_complete);
    for (const Candidate& candidate : decision.targets) {
      if (!isRight(candidate)) ++wrong;
      if (isRight(candidate)) ++right;
      if (candidate.members.size() == 4) ++complete;
    }
  }
  EXPECT_GE(right, 196);  // of 200
  EXPECT_LE(wrong, 2);
  EXPECT_GE(complete, 190);
}

// In one plane with the baseline: every ray of one station crosses every ray of the other, with speeds along
// the plane that fit, too.
TEST(PositionHypotheses, AParallelPairInThePlaneOfTheBaselineIsAmbiguousForTwoStationsAndSolvedByAThird) {
  const std::vector<Target> pair{{{40, 60, 1.0}, {0, 3, 0}}, {{60, 60, 1.0}, {0, 3, 0}}};
  RandomStream random(3);
  PositionHypotheses hypotheses;
  int both_said = 0;
  for (int i = 0; i < 50; ++i) {
    const auto decision = hypotheses.decide(Time(durationOf(0.2 * i)), viewsOf(pair, 2, random), looking(2));
    for (const Candidate& candidate : decision.targets) EXPECT_TRUE(isRight(candidate)) << i;
    const auto said =
        std::count_if(decision.refused.begin(), decision.refused.end(),
                      [](const auto& refused) { return refused.reason != CrossingRefusal::unlikely; });
    if (i >= 5 && said + static_cast<int>(decision.targets.size()) == 4) ++both_said;
  }
  EXPECT_GE(both_said, 40) << "of 45; noise may spoil one crossing for an instant";
  PositionHypotheses with_third;
  HypothesisDecision decision;
  for (int i = 0; i < 5; ++i)
    decision = with_third.decide(Time(durationOf(0.2 * i)), viewsOf(pair, 3, random), looking(3));
  ASSERT_EQ(decision.targets.size(), 2u);
  for (const Candidate& candidate : decision.targets) {
    EXPECT_TRUE(isRight(candidate));
    EXPECT_EQ(candidate.members.size(), 3u);
  }
}

// What a third station that looks there does not see is a ghost, or else it has missed it.
TEST(PositionHypotheses, AStationThatLooksAndDoesNotSeeMakesACrossingLessLikely) {
  RandomStream random(4);
  const auto views = viewsOf({{{50, 60, 20}, {3, 2, 1}}}, 2, random);
  PositionHypotheses two, three, blind;
  auto stations = looking(3);
  const double without = two.decide(Time(durationOf(1.0)), views, looking(2)).targets.at(0).score;
  const double missed = three.decide(Time(durationOf(1.0)), views, stations).targets.at(0).score;
  EXPECT_NEAR(without - missed, -std::log(0.1), 1e-9);
  stations[2].view->half_widths = {0.01, 0.01};
  const double elsewhere = blind.decide(Time(durationOf(1.0)), views, stations).targets.at(0).score;
  EXPECT_DOUBLE_EQ(elsewhere, without);
}

TEST(PositionHypotheses, TheOrderOfTheViewsMakesNoDifference) {
  RandomStream random(5);
  auto views = viewsOf(swarm(8, random), 3, random);
  PositionHypotheses forward, backward;
  const auto a = forward.decide(Time(durationOf(1.0)), views, looking(3));
  std::reverse(views.begin(), views.end());
  const auto b = backward.decide(Time(durationOf(1.0)), views, looking(3));
  ASSERT_EQ(a.targets.size(), b.targets.size());
  for (std::size_t i = 0; i < a.targets.size(); ++i) {
    EXPECT_EQ(a.targets[i].members, b.targets[i].members);
    EXPECT_EQ(a.targets[i].score, b.targets[i].score);
    EXPECT_EQ(a.targets[i].at.point, b.targets[i].at.point);
  }
}

Candidate made(std::vector<ViewKey> members, double score) {
  Candidate candidate;
  candidate.members = std::move(members);
  candidate.score = score;
  return candidate;
}

TEST(PositionHypotheses, TheBestSetIsNotThatOfTheBestCandidate) {
  const std::vector<Candidate> candidates{made({{0, 1}, {1, 2}}, 10.0), made({{0, 1}, {1, 1}}, 7.0),
                                          made({{0, 2}, {1, 2}}, 7.0), made({{0, 3}, {1, 3}}, -1.0)};
  EXPECT_EQ(bestDisjoint(candidates), (std::vector<int>{1, 2}));
  EXPECT_EQ(bestDisjoint(candidates, 1), (std::vector<int>{0}));
}

TEST(PositionHypotheses, TooManyCandidatesAreSaidAndBounded) {
  RandomStream random(6);
  HypothesisParams params;
  params.most_candidates = 10;
  PositionHypotheses hypotheses(params);
  EXPECT_FALSE(hypotheses.decide(Time(durationOf(1.0)), viewsOf(swarm(10, random), 4, random), looking(4))
                   .is_complete);
}

TEST(PositionHypotheses, ParametersOutOfRangeAreRefused) {
  HypothesisParams params;
  params.detection_probability = 1.0;
  EXPECT_THROW(PositionHypotheses{params}, std::invalid_argument);
  params = {};
  params.gate = 0.0;
  EXPECT_THROW(PositionHypotheses{params}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
