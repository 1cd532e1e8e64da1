#include "sightline/core/positions/disjoint_candidates.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

Candidate made(std::vector<ViewKey> members, double score) {
  Candidate candidate;
  candidate.members = std::move(members);
  candidate.score = score;
  return candidate;
}

TEST(DisjointCandidates, TheBestSetIsNotThatOfTheBestCandidate) {
  const std::vector<Candidate> candidates{made({{0, 1}, {1, 2}}, 10.0), made({{0, 1}, {1, 1}}, 7.0),
                                          made({{0, 2}, {1, 2}}, 7.0), made({{0, 3}, {1, 3}}, -1.0)};
  const std::vector<double> scores{10.0, 7.0, 7.0, -1.0};
  EXPECT_EQ(bestOfGroup(candidates, scores, {0, 1, 2, 3}), (std::vector<int>{1, 2}));
  EXPECT_EQ(bestOfGroup(candidates, scores, {0, 2, 3}), (std::vector<int>{0}));
}

TEST(DisjointCandidates, CandidatesThatShareTracksAreOneGroup) {
  const std::vector<Candidate> candidates{made({{0, 1}, {1, 2}}, 1.0), made({{0, 3}, {1, 3}}, 1.0),
                                          made({{1, 2}, {2, 1}}, 1.0)};
  EXPECT_EQ(groupsOf(candidates), (std::vector<std::vector<int>>{{0, 2}, {1}}));
}

TEST(DisjointCandidates, ValuesDecideAndThoseThatAreNotPositiveAreLeftOut) {
  const std::vector<Candidate> candidates{made({{0, 1}, {1, 2}}, 10.0), made({{0, 1}, {1, 1}}, 7.0),
                                          made({{0, 2}, {1, 2}}, 7.0)};
  EXPECT_EQ(bestOfGroup(candidates, {5.0, 1.0, 0.0}, {0, 1, 2}), (std::vector<int>{0}));
  EXPECT_EQ(bestOfGroup(candidates, {5.0, 1.0, 0.0}, {1, 2}), (std::vector<int>{1}));
}

TEST(DisjointCandidates, SharedAndContainedTracksAreFound) {
  const Candidate pair = made({{0, 1}, {1, 2}}, 1.0), triple = made({{0, 1}, {1, 2}, {2, 7}}, 1.0),
                  other = made({{1, 3}, {2, 7}}, 1.0);
  EXPECT_TRUE(isWithin(pair, triple));
  EXPECT_FALSE(isWithin(triple, pair));
  EXPECT_FALSE(isWithin(other, triple));
  EXPECT_FALSE(areDisjoint(triple, other));
  EXPECT_TRUE(areDisjoint(pair, other));
}

}  // namespace
}  // namespace sightline::core
