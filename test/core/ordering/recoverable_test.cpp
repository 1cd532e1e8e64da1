#include "sightline/core/ordering/recoverable.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

using Numbers = std::vector<int>;
using Sum = Recoverable<Numbers, int, std::size_t>;

/// Writes a number down, and throws half-way through a negative one.
std::size_t write(Numbers& numbers, const int& next) {
  numbers.push_back(next);
  if (next < 0) throw std::runtime_error("negative: " + std::to_string(next));
  return numbers.size();
}

std::size_t sizeOf(const int&) {
  return 1;
}

TEST(Recoverable, AnswersAsTheHandlerDoes) {
  Sum sum({}, write, sizeOf);
  EXPECT_EQ(sum.take(3), 1u);
  EXPECT_EQ(sum.take(4), 2u);
  EXPECT_EQ(sum.state(), (Numbers{3, 4}));
}

TEST(Recoverable, AMessageThatThrowsChangesNothingWhateverCameSinceTheLastCopy) {
  for (const std::size_t most : {1u, 2u, 3u, 512u}) {
    RecoverableParams params;
    params.most_messages = most;
    Sum sum({}, write, sizeOf, params);
    for (int k = 0; k < 10; ++k) {
      EXPECT_TRUE(sum.take(k));
      const Numbers before = sum.state();
      EXPECT_FALSE(sum.take(-1));
      EXPECT_EQ(sum.state(), before) << most << " " << k;
    }
  }
}

TEST(Recoverable, FailuresAreCountedUntilOneMessageIsTaken) {
  Sum sum({}, write, sizeOf);
  sum.take(-1);
  EXPECT_FALSE(sum.take(-2));
  EXPECT_EQ(sum.failuresInARow(), 2u);
  EXPECT_EQ(sum.failure(), "negative: -2");
  EXPECT_TRUE(sum.take(1));
  EXPECT_EQ(sum.failuresInARow(), 0u);
}

TEST(Recoverable, WhatChangesTheStateFromOutsideStays) {
  Sum sum({}, write, sizeOf);
  sum.take(1);
  sum.change([](Numbers& numbers) { numbers = {7}; });
  sum.take(-1);
  EXPECT_EQ(sum.state(), Numbers{7});
}

TEST(Recoverable, HandlesNoMoreMessagesAgainThanAllowed) {
  int handled = 0;
  RecoverableParams params;
  params.most_messages = 5;
  params.most_size = 100;
  Sum sum(
      {},
      [&handled](Numbers& numbers, const int& next) {
        ++handled;
        return write(numbers, next);
      },
      [](const int& next) { return next == 50 ? std::size_t{101} : std::size_t{1}; }, params);
  for (int k = 0; k < 1003; ++k) sum.take(1);
  handled = 0;
  sum.take(-1);
  EXPECT_LE(handled, 5);
  sum.take(1);
  sum.take(50);  // too large to be kept
  handled = 0;
  sum.take(-1);
  EXPECT_EQ(handled, 1);
  EXPECT_EQ(sum.state().back(), 50);
}

TEST(Recoverable, CanBeMoved) {
  Sum one({}, write, sizeOf);
  one.take(1);
  Sum two = std::move(one);
  two.take(-1);
  EXPECT_EQ(two.state(), Numbers{1});
}

}  // namespace
}  // namespace sightline::core
