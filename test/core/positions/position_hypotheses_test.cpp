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
    all.push_back({s, kStations[static_cast<std::size_t>(s)], {FieldOfView{}}});
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

/// In the plane of the baseline of the first two stations that rises by 0.01 to the north.
Target inPlane(double x, double y, double vx, double vy) {
  return {{x, y, x / 60.0 + 0.01 * y}, {vx, vy, vx / 60.0 + 0.01 * vy}};
}

// In one plane with the baseline: every ray of one station crosses every ray of the other, with speeds along
// the plane that fit, too. Which of the crossings are nearer, or sharper, must not decide.
TEST(PositionHypotheses, APairInThePlaneOfTheBaselineIsAmbiguousForTwoStationsAndSolvedByAThird) {
  const std::vector<std::vector<Target>> pairs{{inPlane(40, 60, 0, 3), inPlane(60, 60, 0, 3)},
                                               {inPlane(30, 60, 2, 0), inPlane(70, 60, 2, 0)},
                                               {inPlane(30, 60, 2, 1), inPlane(60, 90, -1, -1)}};
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    RandomStream random(3 + k);
    PositionHypotheses hypotheses;
    for (int i = 0; i < 100; ++i) {
      const auto decision =
          hypotheses.decide(Time(durationOf(0.1 * i)), viewsOf(pairs[k], 2, random), looking(2));
      EXPECT_TRUE(decision.targets.empty()) << k << " at " << i;
      const auto ambiguous =
          std::count_if(decision.refused.begin(), decision.refused.end(),
                        [](const auto& refused) { return refused.reason == CrossingRefusal::ambiguous; });
      if (i >= 3) {  // noise may spoil a crossing for an instant: it is said all the same
        EXPECT_EQ(ambiguous, 4) << k << " at " << i;
      }
    }
    PositionHypotheses with_third;
    HypothesisDecision decision;
    for (int i = 0; i < 5; ++i)
      decision = with_third.decide(Time(durationOf(0.2 * i)), viewsOf(pairs[k], 3, random), looking(3));
    ASSERT_EQ(decision.targets.size(), 2u) << k;
    for (const Candidate& candidate : decision.targets) {
      EXPECT_TRUE(isRight(candidate)) << k;
      EXPECT_EQ(candidate.members.size(), 3u) << k;
    }
  }
}

// They leave the plane: what was ambiguous is settled in favour of the crossings that still fit, and the
// others are ghosts.
TEST(PositionHypotheses, APairThatLeavesThePlaneOfTheBaselineIsSettled) {
  RandomStream random(9);
  PositionHypotheses hypotheses;
  HypothesisDecision decision;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.1 * i;
    std::vector<Target> pair{inPlane(30 + 2 * t, 60, 2, 0), inPlane(70 + 2 * t, 60, 2, 0)};
    if (t > 2.0) {
      pair[1].position.z() += 0.5 * (t - 2.0);
      pair[1].velocity.z() += 0.5;
    }
    decision = hypotheses.decide(Time(durationOf(t)), viewsOf(pair, 2, random), looking(2));
    if (t < 2.0) {
      EXPECT_TRUE(decision.targets.empty()) << t;
    }
    for (const Candidate& candidate : decision.targets) EXPECT_TRUE(isRight(candidate)) << t;
  }
  EXPECT_EQ(decision.targets.size(), 2u);
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
  stations[2].views = {stations[2].views[0], stations[2].views[0]};  // two sensors, neither looks there
  for (FieldOfView& view : stations[2].views) view.half_widths = {0.01, 0.01};
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
  params.least_fit_margin = -1.0;
  EXPECT_THROW(PositionHypotheses{params}, std::invalid_argument);
  params = {};
  params.gate = 0.0;
  EXPECT_THROW(PositionHypotheses{params}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
