#include "sightline/core/ordering/settings_history.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

Time at(int t) {
  return Time(std::chrono::seconds(t));
}

TEST(SettingsHistory, EachHoldsForWhatIsLaterThanItsTimeAndUpToTheNext) {
  SettingsHistory<int> history(1);
  history.change(2, at(10));
  history.change(3, at(20));
  EXPECT_EQ(*history.at(at(-1000)), 1);
  EXPECT_EQ(*history.at(at(10)), 1) << "what is of the time of the change is not later";
  EXPECT_EQ(*history.at(at(11)), 2);
  EXPECT_EQ(*history.at(at(20)), 2);
  EXPECT_EQ(*history.at(at(21)), 3);
  EXPECT_EQ(*history.newest(), 3);
}

TEST(SettingsHistory, OfSeveralChangesAtOneTimeTheLastOneHolds) {
  SettingsHistory<int> history(1);
  history.change(2, at(10));
  history.change(3, at(10));
  EXPECT_EQ(*history.at(at(11)), 3);
  EXPECT_EQ(history.size(), 2u);
}

TEST(SettingsHistory, AChangeAtAnEarlierTimeEndsThoseAfterIt) {
  SettingsHistory<int> history(1);
  history.change(2, at(20));
  history.change(3, at(10));
  EXPECT_EQ(*history.at(at(15)), 3);
  EXPECT_EQ(*history.at(at(25)), 3);
}

TEST(SettingsHistory, IsBoundedByWhatMayStillBeAskedFor) {
  SettingsHistory<int> history(0);
  for (int k = 1; k <= 1000; ++k) {
    history.forgetBefore(at(k - 5));
    history.change(k, at(k));
    ASSERT_EQ(*history.at(at(std::max(0, k - 5))), std::max(0, k - 6));
  }
  EXPECT_LE(history.size(), 8u);
}

TEST(SettingsHistory, CopiesShareTheSettingsAndAreIndependent) {
  SettingsHistory<int> history(1);
  SettingsHistory<int> copy = history;
  EXPECT_EQ(history.newest(), copy.newest());
  copy.startWith(2);
  EXPECT_EQ(*history.newest(), 1);
  EXPECT_EQ(*copy.at(at(-1)), 2);
}

}  // namespace
}  // namespace sightline::core
