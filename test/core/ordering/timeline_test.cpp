#include "sightline/core/ordering/timeline.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

struct Item {
  double time = 0.0;  // [s]
  int content = 0;
  bool is_alarm = false;  // shows that the items of the last second are to be used otherwise
};

Time timeOf(const Item& item) {
  return Time(durationOf(item.time));
}

bool precedes(const Item& a, const Item& b) {
  return std::make_tuple(timeOf(a), a.content) < std::make_tuple(timeOf(b), b.content);
}

/// Depends on every item, on how each was used and on their order.
struct State {
  double sum = 0.0;
  int processed = 0;
};

using TestTimeline = Timeline<Item, double, State>;

TimelineParams paramsOf(double span, double interval) {
  TimelineParams params;
  params.span = span;
  params.interval = interval;
  return params;
}

/// An owner as the trackers are: processes each item in its place, and again after an alarm.
class Owner {
 public:
  explicit Owner(const TimelineParams& params) : timeline(params) {}

  void take(const Item& item) {
    const std::size_t place = timeline.insert(item);
    if (place < timeline.next()) timeline.restore(place == 0 ? 0 : place - 1, state);
    Time newest{};
    for (; timeline.next() < timeline.size(); timeline.advance()) {
      timeline.keepIfDue(state);
      timeline.use(timeline.next(), 1.0);
      const Item& next = timeline[timeline.next()].item;
      newest = timeOf(next);
      if (next.is_alarm) processAgain(next.time - 1.0);
      process();
    }
    timeline.close(newest);
    timeline.dropClosed();
  }

  TestTimeline timeline;
  State state;

 private:
  void process() {
    const TestTimeline::Entry& entry = timeline[timeline.next()];
    state.sum = std::cos(state.sum + entry.use * entry.item.content);
    ++state.processed;
  }

  void processAgain(double since) {
    const std::size_t alarm = timeline.next();
    const std::size_t first = timeline.firstNotBefore(Time(durationOf(since)));
    timeline.rollBack(first, state);
    for (std::size_t k = first; k <= alarm; ++k) timeline.use(k, 9.0);
    for (; timeline.next() < alarm; timeline.advance()) {
      timeline.keepIfDue(state);
      process();
    }
    timeline.keepIfDue(state);
  }
};

std::vector<Item> itemsOf(int count, int items_an_alarm) {
  std::vector<Item> items;
  for (int k = 0; k < count; ++k)
    items.push_back({0.01 * k, k, items_an_alarm > 0 && k % items_an_alarm == items_an_alarm - 1});
  return items;
}

/// The items as they arrive, each up to `lag` seconds late.
std::vector<Item> delayed(const std::vector<Item>& items, double lag, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> delay(0.0, lag);
  std::vector<std::pair<double, Item>> arrivals;
  for (const Item& item : items) arrivals.emplace_back(item.time + delay(random), item);
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Item> late;
  for (const auto& arrival : arrivals) late.push_back(arrival.second);
  return late;
}

void expectSameAsInOrder(const std::vector<Item>& arrivals, const TimelineParams& params) {
  std::vector<Item> ordered = arrivals;
  std::sort(ordered.begin(), ordered.end(), [](const Item& a, const Item& b) { return precedes(a, b); });
  Owner in_order(params), late(params);
  for (const Item& item : ordered) in_order.take(item);
  for (const Item& item : arrivals) late.take(item);
  EXPECT_EQ(late.state.sum, in_order.state.sum);
  EXPECT_EQ(late.state.processed, in_order.state.processed);
  ASSERT_EQ(late.timeline.size(), in_order.timeline.size());
  for (std::size_t k = 0; k < late.timeline.size(); ++k) {
    EXPECT_EQ(late.timeline[k].item.content, in_order.timeline[k].item.content);
    EXPECT_EQ(late.timeline[k].use, in_order.timeline[k].use) << k;
    ASSERT_EQ(late.timeline[k].before == nullptr, in_order.timeline[k].before == nullptr) << k;
    if (!late.timeline[k].before) continue;
    EXPECT_EQ(late.timeline[k].before->sum, in_order.timeline[k].before->sum) << k;
  }
}

TEST(Timeline, LateItemsGiveTheSameStateAsItemsInOrder) {
  for (unsigned seed = 1; seed <= 10; ++seed)
    expectSameAsInOrder(delayed(itemsOf(400, 0), 0.5, seed), paramsOf(2.0, 0.1));
}

TEST(Timeline, LateItemsBeforeAnAlarmGiveTheSameStateAsItemsInOrder) {
  for (unsigned seed = 1; seed <= 10; ++seed)
    expectSameAsInOrder(delayed(itemsOf(400, 37), 0.5, seed), paramsOf(2.0, 0.1));
}

TEST(Timeline, ItemsOfOneInstantMayComeInAnyOrder) {
  std::vector<Item> items;
  for (int k = 0; k < 6; ++k) items.push_back({1.0, k, k == 3});
  items.push_back({0.5, 10});
  items.push_back({1.5, 11});
  std::mt19937_64 random(3);
  for (int round = 0; round < 50; ++round) {
    std::shuffle(items.begin(), items.end(), random);
    expectSameAsInOrder(items, paramsOf(2.0, 0.1));
  }
}

TEST(Timeline, ALaterItemUndoesTheRollBacksOfTheItemsAfterIt) {
  TestTimeline timeline(paramsOf(2.0, 0.1));
  for (int k = 0; k < 100; ++k) {
    timeline.insert({0.01 * k, k});
    timeline.keepIfDue({static_cast<double>(k), k});
    timeline.use(timeline.next(), 1.0);
    if (k < 90) timeline.advance();
    if (k == 90) break;
  }
  State state;
  timeline.rollBack(50, state);
  EXPECT_EQ(state.processed, static_cast<int>(timeline.next()));
  for (std::size_t k = 50; k <= 90; ++k) timeline.use(k, 9.0);
  for (; timeline.next() <= 90; timeline.advance()) timeline.keepIfDue({-1.0, -1});
  EXPECT_EQ(timeline[60].use, 9.0);
  EXPECT_EQ(timeline[timeline.keptAt(80)].before->processed, -1);

  const std::size_t place = timeline.insert({0.8051, 0});
  EXPECT_EQ(place, 81u);
  const std::size_t start = timeline.restore(place - 1, state);
  EXPECT_LE(start, place);
  EXPECT_EQ(state.processed, static_cast<int>(start));  // the state from before the roll-back, not -1
  EXPECT_EQ(timeline[60].use, 1.0);
}

TEST(Timeline, AnItemAfterARollBackLeavesItAsItIs) {
  Owner owner(paramsOf(2.0, 0.1));
  for (const Item& item : itemsOf(100, 60)) owner.take(item);
  EXPECT_EQ(owner.timeline[30].use, 9.0);
  owner.take({0.9551, 7});
  EXPECT_EQ(owner.timeline[30].use, 9.0);
}

TEST(Timeline, AnItemTakenOutLeavesNoTrace) {
  Owner with(paramsOf(10.0, 0.1)), without(paramsOf(10.0, 0.1));
  for (const Item& item : itemsOf(100, 0)) {
    with.take(item);
    if (item.content != 40) without.take(item);
  }
  with.timeline.restore(40, with.state);
  with.timeline.erase(40);
  with.take({1.0, 100});
  without.take({1.0, 100});
  EXPECT_EQ(with.state.sum, without.state.sum);
  EXPECT_EQ(with.state.processed, without.state.processed);
}

TEST(Timeline, AStateBeforeTheItemTakenOutIsTheOneBeforeItsSuccessor) {
  Owner owner(paramsOf(10.0, 0.1));
  for (const Item& item : itemsOf(5, 0)) owner.take(item);
  owner.timeline.restore(0, owner.state);
  owner.timeline.erase(0);
  ASSERT_NE(owner.timeline[0].before, nullptr);
  EXPECT_EQ(owner.timeline[0].before->processed, 0);
  EXPECT_EQ(owner.timeline[0].item.content, 1);
}

TEST(Timeline, ForgetsWhatNobodyRollsBackTo) {
  Owner owner(paramsOf(2.0, 0.1));
  for (const Item& item : itemsOf(10000, 50)) {
    owner.take(item);
    ASSERT_LE(owner.timeline.size(), 250u);
    ASSERT_LE(timeOf(owner.timeline[0].item), Time(durationOf(std::max(item.time - 2.0, 0.0))));
    ASSERT_NE(owner.timeline[0].before, nullptr);
  }
}

TEST(Timeline, HoldsNotMoreThanTheMostItemsHoweverCloseTheyAre) {
  TimelineParams params = paramsOf(2.0, 0.1);
  params.most_items = 64;
  Owner owner(params);
  for (int k = 0; k < 10000; ++k) {
    owner.take({0.1 * (k / 10), k});
    ASSERT_LE(owner.timeline.size(), 64u + 10u);
  }
}

TEST(Timeline, ClosedItemsStayUntilDroppedAndNothingIsPutBeforeTheOpenOnes) {
  TestTimeline timeline(paramsOf(0.5, 0.1));
  for (int k = 0; k < 100; ++k) {
    timeline.insert({0.01 * k, k});
    timeline.keepIfDue({0.0, k});
    timeline.advance();
  }
  EXPECT_TRUE(timeline.close(Time(durationOf(0.99))));
  EXPECT_FALSE(timeline.close(Time(durationOf(0.99))));
  EXPECT_EQ(timeline.size(), 100u);
  const std::size_t open = timeline.open();
  EXPECT_LE(timeOf(timeline[open].item), Time(durationOf(0.49)));
  EXPECT_GT(timeOf(timeline[open].item), Time(durationOf(0.37)));
  EXPECT_NE(timeline[open].before, nullptr);
  timeline.dropClosed(7);
  EXPECT_EQ(timeline.open(), 7u);
  EXPECT_EQ(timeline.next(), timeline.size());
  EXPECT_EQ(timeline[7].item.content, static_cast<int>(open));
  EXPECT_EQ(timeline.insert({0.0, 0}), 7u);
}

TEST(Timeline, HoldsTellsEqualItemsFromOthersOfTheirInstant) {
  Owner owner(paramsOf(2.0, 0.1));
  for (const Item& item : itemsOf(20, 0)) owner.take(item);
  EXPECT_TRUE(owner.timeline.holds({0.05, 5}));
  EXPECT_FALSE(owner.timeline.holds({0.05, 6}));
  EXPECT_FALSE(owner.timeline.holds({0.055, 5}));
}

TEST(Timeline, CopiesAreIndependent) {
  Owner original(paramsOf(2.0, 0.1));
  for (const Item& item : itemsOf(100, 30)) original.take(item);
  Owner copy = original;
  Owner untouched = original;
  copy.take({0.4551, 1000});  // rolls back and undoes what came after
  for (const Item& item : delayed(itemsOf(100, 0), 0.2, 1)) copy.take({item.time + 1.0, item.content});
  ASSERT_EQ(original.timeline.size(), untouched.timeline.size());
  for (std::size_t k = 0; k < original.timeline.size(); ++k) {
    EXPECT_EQ(original.timeline[k].use, untouched.timeline[k].use);
    EXPECT_EQ(original.timeline[k].before, untouched.timeline[k].before);
  }
  original.take({0.3551, 2000});
  untouched.take({0.3551, 2000});
  EXPECT_EQ(original.state.sum, untouched.state.sum);
}

TEST(Timeline, ByTheClockStatesAreKeptAtThePlacesThatTheClockGives) {
  TimelineParams params = paramsOf(10.0, 0.1);
  params.spacing = Spacing::by_clock;
  Owner early(params), late(params);
  for (const Item& item : itemsOf(100, 0)) {
    early.take(item);
    if (item.content >= 33) late.take(item);
  }
  for (std::size_t k = 34; k < 100; ++k)
    EXPECT_EQ(early.timeline[k].before == nullptr, late.timeline[k - 33].before == nullptr) << k;
  EXPECT_NE(early.timeline[40].before, nullptr);
  EXPECT_EQ(early.timeline[41].before, nullptr);
}

TEST(Timeline, SearchesByTimeReachTheItemsBesideIt) {
  Owner owner(paramsOf(2.0, 0.1));
  for (const Item& item : itemsOf(50, 0)) owner.take(item);
  EXPECT_EQ(owner.timeline.firstNotBefore(Time(durationOf(0.2))), 20u);
  EXPECT_EQ(owner.timeline.firstNotBefore(Time(durationOf(0.205))), 21u);
  EXPECT_EQ(owner.timeline.lastNotAfter(Time(durationOf(0.2))), 20u);
  EXPECT_EQ(owner.timeline.lastNotAfter(Time(durationOf(0.205))), 20u);
  EXPECT_EQ(owner.timeline.lastNotAfter(Time(durationOf(-1.0))), 0u);
}

}  // namespace
}  // namespace sightline::core
